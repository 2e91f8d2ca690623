"""The service's life: installed, booted, confined, reloaded, stopped dead, upgraded, removed."""
from device_scenarios import as_it_came, expect, wait_for_tower
from machine import wait_until


def the_package_installs(box):
    """Nothing but the package and its dependencies; the service waits to be enabled."""
    box.machine.wait_for_boot()
    box.install()
    expect(box.run("systemctl is-enabled depthscope", check=False) == "disabled", "the service enabled itself")
    groups = box.run("id -nG depthscope").split()
    expect({"video", "render", "input"} <= set(groups), f"the user is in {groups}")
    expect(box.run("stat -c %G /dev/gpiochip0") == "depthscope", "the footswitch's device is not the user's")
    box.configure()
    box.run("systemctl enable --quiet depthscope")


def the_picture_comes_before_the_network(box):
    """Booted anew, the service runs by itself, its first picture out before the network starts."""
    box.reboot()
    box.wait_for_status(lambda s: s["display"] == "ok", "a lit monitor after boot")
    wait_until(lambda: box.property("ActiveState") == "active", "the service is up")
    started = int(box.property("ActiveEnterTimestampMonotonic"))
    network = int(box.run("systemctl show systemd-networkd --value --property=ExecMainStartTimestampMonotonic"))
    expect(0 < started <= network, f"ready after {started} us, the network started at {network} us")
    expect(box.run("systemctl is-active getty@tty1", check=False) != "active", "a login prompt runs on the monitor")


def the_service_is_confined(box):
    """Its own user, no capability, only the devices it needs."""
    pid = box.property("MainPID")
    process = box.run(f"cat /proc/{pid}/status")
    expect("CapEff:\t0000000000000000" in process, "it has capabilities")
    expect(box.run(f"stat -c %U /proc/{pid}") == "depthscope", "it runs as another user")
    # Field 41 of stat(5) is the policy, 1 is SCHED_FIFO; the name before it has no blanks here.
    policies = box.run(f"cut -d ' ' -f 41 /proc/{pid}/task/*/stat").split()
    expect("1" in policies, f"no thread under SCHED_FIFO: policies {policies}")
    expect("VmLck:\t       0 kB" not in process, "its memory is not locked")
    for complaint in ("no real-time priority", "memory is not locked", "without its limits"):
        expect(complaint not in box.journal(), complaint)


def the_log_has_fields(box):
    """The journal can be asked by what a message is about."""
    pid = box.status()["ar_pid"]
    found = box.run(f"journalctl --boot --output=cat DEPTHSCOPE_PID={pid} PRIORITY=6")
    expect("AR process started" in found, f"nothing about process {pid}: {found}")


def a_reload_applies_what_it_can(box):
    """SIGHUP takes over live keys, names those that need a restart; a broken file changes nothing."""
    file = "/etc/depthscope/depthscope.toml"
    box.run(f"sed -i -e 's/^inset = .*/&\\nopacity = 0.3/' -e 's/^features = .*/features = 900/' {file}")
    box.run("systemctl reload depthscope")
    wait_until(lambda: "applied=overlay.opacity needs_restart=slam.extractor.features" in box.journal(),
               "the log names what was applied")
    box.run(f"sed -i 's/opacity = 0.3/opacity = 3/' {file}")
    answer = box.run("systemctl reload depthscope", check=False)
    expect("failed" in answer, f"a broken file was accepted: {answer}")
    expect(box.property("ActiveState") == "active", "a broken file ended the service")
    box.configure()
    box.run("systemctl reload depthscope")


def the_watchdog_restarts_a_stopped_daemon(box):
    before = box.property("MainPID")
    box.run(f"kill -STOP {before}")
    wait_until(lambda: box.property("MainPID") not in (before, "0"), "another process")
    expect("watchdog" in box.run("journalctl --boot --output=cat _PID=1 --unit=depthscope").lower(), "not the watchdog's doing")
    wait_for_tower(box)


def an_upgrade_keeps_everything(box):
    """The same package over itself: configuration kept, service running again."""
    configuration = box.run("sha256sum /etc/depthscope/depthscope.toml")
    before = box.property("MainPID")
    # AR steps back, as it does on a real box; here it was to be fast (daemon.ar_nice).
    pid = box.wait_for_status(lambda s: s["ar_alive"], "AR runs")["ar_pid"]
    box.run(f"renice --priority 19 $(ls /proc/{pid}/task)")
    box.run("dpkg --install /run/payload/depthscope.deb")
    expect(box.run("sha256sum /etc/depthscope/depthscope.toml") == configuration, "the configuration was changed")
    expect(box.property("MainPID") != before, "the old program still runs")
    wait_for_tower(box)


def expect_console(box):
    """The kernel's own picture is on the monitor, in its own mode, with something written on it."""
    def console():
        screen = box.screen()
        return (screen.width, screen.height) == (1280, 720) and screen.number() is None and any(screen.pixels)
    wait_until(console, "the console on the monitor")


def a_crash_gives_the_console_back(box):
    """However the program ends: here it cannot do anything about it itself, and nobody starts it again."""
    never = "/run/systemd/system/depthscope.service.d/never.conf"
    box.run(f"install -D /dev/null {never} && printf '[Service]\\nRestart=no\\n' >{never} && systemctl daemon-reload")
    box.run(f"kill -KILL {box.property('MainPID')}")
    expect_console(box)
    box.run(f"rm {never} && systemctl daemon-reload && systemctl start depthscope")
    wait_for_tower(box)


def the_graphics_processor_shows_the_same(box):
    """Its driver in the picture's way for once (Mesa's for the processor, through GBM): every pixel as it came."""
    file = "/etc/depthscope/depthscope.toml"
    box.run(f"sed -i 's/^kind = .*/&\\nroute = \"gpu\"/' {file}")
    box.run("systemctl restart depthscope")
    wait_until(lambda: "composed by the graphics processor" in box.journal(), "the log says who composes")
    wait_for_tower(box)
    box.run("/run/payload/ask 'overlay off'")
    box.tower.hold()
    wait_until(lambda: as_it_came(box), "every pixel as it came, but for the status mark")
    expect("composed by the processor" not in box.journal(), "it was given up")
    box.tower.go_on()
    box.configure()
    box.run("systemctl restart depthscope")
    wait_for_tower(box)


def a_stop_gives_the_console_back(box):
    box.run("sleep 3")
    expect(box.property("ActiveState") == "active", "it did not stay up: " + box.property("ActiveState"))
    box.run("systemctl stop depthscope")
    expect(box.property("Result") == "success", "ended with " + box.property("Result"))
    expect(box.run("ls /run/depthscope", check=False).startswith("ls: cannot access"), "the control socket is still there")
    wait_until(lambda: box.run("systemctl is-active getty@tty1", check=False) == "active", "a login prompt")
    expect_console(box)
    expect(box.run("grep -l depthscope /proc/[0-9]*/comm", check=False) == "", "processes are left")


def every_format_of_the_card_is_captured_right(box):
    """Colour bars in each promised pixel format, from 480p to 1080p; the service is stopped, the card free."""
    box.tower.stop()
    box.run("v4l2-ctl --device=/dev/video0 "
            "--set-ctrl=loop_video=0,percentage_of_dropped_buffers=0,dv_timings_signal_mode=0")
    lines = box.run("/run/payload/capture_check /dev/video0 2", check=False).splitlines()
    for size in ("640x480", "1280x720", "1920x1080"):
        for pixels in ("YUYV", "UYVY", "NV12", "NV16", "YU12", "BGR3", "RGB3", "XR24", "GREY"):
            right = [line for line in lines if line.startswith("ok ") and f" {size} {pixels}:" in line]
            expect(right, f"{size} {pixels} is not captured right:\n" + "\n".join(lines))


def removal_leaves_nothing_broken(box):
    box.run("systemctl start depthscope")
    box.run("dpkg --purge depthscope")
    expect(box.run("systemctl is-failed depthscope", check=False) != "failed", "a failed unit is left")
    left = box.run("ls -d /etc/depthscope /var/lib/depthscope /run/depthscope /etc/systemd/system/*/depthscope* 2>/dev/null",
                   check=False).split()
    expect(left in ([], ["/etc/depthscope"]), f"left behind: {left}")
    expect(box.run("systemctl --failed --no-legend --plain") == "", "failed units")
    box.machine.power_off()


FIRST = [
    the_package_installs,
    the_picture_comes_before_the_network,
    the_service_is_confined,
    the_log_has_fields,
    a_reload_applies_what_it_can,
]
LAST = [
    the_watchdog_restarts_a_stopped_daemon,
    an_upgrade_keeps_everything,
    the_graphics_processor_shows_the_same,
    a_crash_gives_the_console_back,
    a_stop_gives_the_console_back,
    every_format_of_the_card_is_captured_right,
    removal_leaves_nothing_broken,
]
