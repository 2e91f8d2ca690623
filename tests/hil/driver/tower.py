"""The endoscope tower: vivid's output, which feeds its HDMI input, and the state of the signal between them."""
CAPTURE, OUTPUT = "/dev/video0", "/dev/video1"
# Values of vivid's control dv_timings_signal_mode.
NO_SIGNAL, NO_LOCK, OUT_OF_RANGE, SELECTED = 1, 2, 3, 4
CLIP_MODE = "640x480p59"  # as vivid names it


class Tower:
    def __init__(self, machine):
        self._machine = machine

    def _control(self, assignment):
        self._machine.run(f"v4l2-ctl --device={CAPTURE} --set-ctrl={assignment}")

    def slow_down(self):
        """Two pictures in five are as much as the emulated processor can take."""
        self._control("percentage_of_dropped_buffers=60")

    def play(self):
        """Sends the clip, 640x480, forth and back, as fast as AR sees it."""
        self._machine.start("tower", "/run/payload/tower", OUTPUT, "/run/payload/clip.yuyv")
        self._control("osd_text_mode=2")
        self.show_clip()

    def hold(self):
        """The picture on the line stays."""
        self._machine.run("systemctl kill --signal=STOP tower")

    def go_on(self):
        self._machine.run("systemctl kill --signal=CONT tower")

    def stop(self):
        self._machine.run("systemctl kill --signal=KILL tower; systemctl stop tower", check=False)

    def show_colour_bars(self, mode):
        """vivid's own test pattern instead of the clip."""
        self._control("loop_video=0")
        self.signal(mode)

    def show_clip(self):
        self._control("loop_video=1")
        self.signal(CLIP_MODE)

    def signal(self, mode):
        """A good signal of this mode, as vivid names it, or one of the bad states."""
        if isinstance(mode, int):
            self._control(f"dv_timings_signal_mode={mode}")
            return
        menu = self._machine.run(f"v4l2-ctl --device={CAPTURE} --list-ctrls-menus")
        index = next(line.split(":")[0].strip() for line in menu.split("dv_timings ")[1].splitlines()[1:]
                     if line.split(":", 1)[1].strip() == mode)
        self._control(f"dv_timings={index}")
        self._control(f"dv_timings_signal_mode={SELECTED}")

    def damage_one_frame(self):
        self._control("inject_v4l2_buf_flag_error=1")

    def unplug(self):
        """The card vanishes from under whoever has it open. vivid brings it back when its last user is gone, so one
        holds on."""
        self.stop()
        self._machine.start("holder", "sh", "-c", f"exec 3<>{OUTPUT}; exec sleep 10000")
        self._machine.run("until ls -l /proc/[0-9]*/fd/3 2>/dev/null | grep -q /dev/video1; do sleep 0.2; done")
        self._control("disconnect=1")

    def plug_in(self):
        self._machine.run("systemctl stop holder")


def press_footswitch(machine):
    """On the simulated GPIO line, for long enough to be no bounce."""
    pull = "/sys/devices/platform/gpio-sim.0/gpiochip*/sim_gpio4/pull"
    machine.run(f"for level in pull-up pull-down; do echo $level >$(echo {pull}); sleep 0.3; done")


def press_pedal_key(machine):
    """On the keyboard, which stands for a USB pedal; key 30 is A."""
    for down in (True, False):
        machine.qmp("input-send-event", events=[
            {"type": "key", "data": {"down": down, "key": {"type": "qcode", "data": "a"}}}])
        machine.run("sleep 0.2")
