"""What needs the devices: the picture from the tower to the monitor, the pedals, and all that can happen to a signal.

The guest's processor is emulated and slow: what must be is waited for, rates and delays are not judged here.
"""
from machine import PATIENCE_S, Failure, comes, wait_until
from pictures import differing_pixels
from tower import NO_LOCK, NO_SIGNAL, OUT_OF_RANGE, press_footswitch, press_pedal_key

TOLERANCE = 2  # levels: one from rounding on either side
SMPTE_BARS = [(191, 191, 191), (191, 191, 0), (0, 191, 191), (0, 191, 0), (191, 0, 191), (191, 0, 0), (0, 0, 191)]


def expect(condition, message):
    if not condition:
        raise Failure(message)


def shown_number(box):
    """The number of the tower's picture on the monitor, or None."""
    screen = box.screen()
    return screen.number() if (screen.width, screen.height) == (640, 480) else None


def wait_for_tower(box):
    """Until the tower's picture is on the monitor; its number."""
    def numbers():
        found = shown_number(box)
        return [] if found is None else [found]
    return wait_until(numbers, "the tower's picture on the monitor")[0]


def wait_for_tracking(box):
    """Until AR has a map to make a surface from; the status."""
    return box.wait_for_status(lambda s: s.get("map_points", 0) > 300 and s["overlay"] == "tracking", "AR tracks")


def differences_from_source(box, screen):
    """A picture of the monitor against the tower's picture in it, computed by the book: pixels that differ, or None when
    there is no such picture. The first two pixels are left out, vivid does not loop them."""
    number = screen.number() if (screen.width, screen.height) == (640, 480) else None
    if number is None:
        return None
    return [p for p in differing_pixels(screen, box.clip.rgb(number), TOLERANCE) if p not in ((0, 0), (1, 0))]


def as_it_came(box):
    """Whether the monitor shows the tower's picture and nothing else but the status mark: the processor is too slow to
    keep up, now and then the picture is marked as late, and dark."""
    differing = differences_from_source(box, box.screen())
    return differing is not None and all(x < 320 and y < 48 for x, y in differing)


def the_towers_picture_is_on_the_monitor(box):
    """Without overlay, every pixel as the tower sent it."""
    box.tower.play()
    wait_for_tower(box)
    box.run("/run/payload/ask 'overlay off'")
    box.tower.hold()
    wait_until(lambda: as_it_came(box), "every pixel as it came, but for the status mark")
    first = wait_for_tower(box)
    box.tower.go_on()
    wait_until(lambda: shown_number(box) not in (None, first), "the picture moves")


def the_footswitch_asks_for_a_surface(box):
    """The scope moves, AR tracks; a press makes a surface, and it lies over the picture, nothing else changed."""
    box.run("/run/payload/ask 'overlay chromadepth'")
    expect(wait_for_tracking(box)["surfaces"] == 0, "a surface that nobody asked for")

    def overlay_is_on():
        screen = box.screen()
        share = len(differences_from_source(box, screen) or []) / (640 * 480)
        return screen if 0.03 < share < 0.9 else None

    def surface_by_a_press():
        """Nothing where AR took up another map meanwhile, or had too few pictures yet: as a surgeon would, press again."""
        before = wait_for_tracking(box)
        press_footswitch(box.machine)
        box.wait_for_status(lambda s: s["footswitch_presses"] == before["footswitch_presses"] + 1, "the press is counted")
        if not comes(lambda: box.status().get("surfaces", 0) > before["surfaces"], PATIENCE_S / 10):
            return None
        box.tower.hold()
        screen = comes(overlay_is_on, PATIENCE_S / 10)
        box.tower.go_on()
        return screen
    box.keep(wait_until(surface_by_a_press, "the surface over the picture"), "ar_on")


def a_pedal_that_is_a_keyboard_works_too(box):
    before = box.status()
    press_pedal_key(box.machine)
    box.wait_for_status(lambda s: s["footswitch_presses"] > before["footswitch_presses"], "the press is counted")


def the_surface_goes_with_the_ar_process(box):
    """AR killed: the picture goes on, and what it had drawn is gone."""
    before = box.status()
    box.run(f"kill -KILL {before['ar_pid']}")
    box.wait_for_status(lambda s: s["frames_shown"] > before["frames_shown"] + 3, "pictures without AR")
    wait_for_tower(box)
    after = box.wait_for_status(lambda s: s["ar_alive"] and s["ar_pid"] != before["ar_pid"], "AR comes back")
    expect(after["ar_restarts"] == before["ar_restarts"] + 1, "not restarted once")
    expect(box.property("NRestarts") == "0", "the service was restarted")


def signal_fault(box, mode, status, name):
    """One bad state of the signal: its picture, and the tower's again afterwards."""
    box.tower.signal(mode)
    box.wait_for_status(lambda s: s["source"] == status, status)
    wait_until(lambda: shown_number(box) is None, f"a picture that says {status}")
    box.keep_screen(name)
    box.tower.show_clip()
    wait_for_tower(box)


def a_pulled_cable_is_said_and_recovers(box):
    """vivid takes the 5 V of the cable away together with the signal."""
    signal_fault(box, NO_SIGNAL, "no cable", "no_cable")


def an_unstable_signal_is_said_and_recovers(box):
    signal_fault(box, NO_LOCK, "unstable sync", "unstable_sync")


def a_mode_out_of_range_is_said_and_recovers(box):
    signal_fault(box, OUT_OF_RANGE, "unsupported mode", "unsupported_mode")


def a_changed_mode_is_followed(box):
    """720p colour bars, right in colour and size, marked as too large for the camera file, and back."""
    box.tower.show_colour_bars("1280x720p60")

    def bars():
        screen = box.screen()
        if screen.width < 1280 or screen.height < 720:
            return None
        seen = [screen.at(1280 * (2 * i + 1) // 16, screen.height // 2) for i in range(7)]
        near = all(abs(a - b) <= 4 for bar, wanted in zip(seen, SMPTE_BARS) for a, b in zip(bar, wanted))
        return screen if near else None
    wait_until(bars, "colour bars in 720p")
    box.wait_for_status(lambda s: s["overlay"] == "no AR", "the mark that says that there is no AR")
    box.keep(wait_until(bars, "colour bars in 720p"), "changed_mode")
    box.tower.show_clip()
    wait_for_tower(box)


def a_monitor_unplugged_is_said_and_lit_again(box):
    """The kernel is told that the plug is out. The picture needs nobody to look at it in order to go on."""
    status = "$(echo /sys/class/drm/card*-Virtual-1/status)"
    box.run(f"echo off >{status}")
    before = box.wait_for_status(lambda s: s["display"] == "no monitor", "no monitor")
    box.wait_for_status(lambda s: s["frames_given_up"] > before["frames_given_up"] + 3 and s["source"] == "ok",
                        "pictures come in all the same")
    box.run(f"echo detect >{status}")
    box.wait_for_status(lambda s: s["display"] == "ok", "the monitor is lit")
    wait_for_tower(box)


def damaged_frames_are_not_shown(box):
    """vivid flags the buffer that comes next, be it one that the tower sends or one that the card receives: the tower
    holds meanwhile, and a flag that went to a picture still under way is followed by another."""
    before = box.status()["frames_damaged"]
    box.tower.hold()

    def counted(status):
        if status["frames_damaged"] > before:
            return True
        box.tower.damage_one_frame()
        return False
    box.wait_for_status(counted, "a damaged frame is counted")
    box.tower.go_on()
    wait_for_tower(box)


def a_card_unplugged_is_said_and_found_again(box):
    box.tower.unplug()
    box.wait_for_status(lambda s: s["source"] == "no device", "no device")
    box.keep_screen("no_device")
    box.tower.plug_in()
    box.tower.play()
    wait_for_tower(box)


ALL = [
    the_towers_picture_is_on_the_monitor,
    the_footswitch_asks_for_a_surface,
    a_pedal_that_is_a_keyboard_works_too,
    the_surface_goes_with_the_ar_process,
    a_pulled_cable_is_said_and_recovers,
    an_unstable_signal_is_said_and_recovers,
    a_mode_out_of_range_is_said_and_recovers,
    a_changed_mode_is_followed,
    a_monitor_unplugged_is_said_and_lit_again,
    damaged_frames_are_not_shown,
    a_card_unplugged_is_said_and_found_again,
]
