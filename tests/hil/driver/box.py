"""The box under test: the service in the guest, its devices, and its monitor."""
import json
import os

from machine import Failure, wait_until
from pictures import Picture
from tower import Tower


class Box:
    def __init__(self, machine, clip, folder):
        self.machine, self.clip, self._folder = machine, clip, folder
        self.tower = Tower(machine)

    def run(self, command, **options):
        return self.machine.run(command, **options)

    def install(self):
        """The package, from the payload disk, as an administrator would."""
        self.run("mkdir -p /run/payload && mount -o ro /dev/vdb /run/payload")
        self.run("dpkg --install /run/payload/depthscope.deb")

    def configure(self):
        self.run("cp /run/payload/depthscope.toml /etc/depthscope/depthscope.toml")
        self.run("install -D -m 644 /run/payload/slow.conf /etc/systemd/system/depthscope.service.d/slow.conf")
        self.run("systemctl daemon-reload")

    def reboot(self):
        self.machine.reboot()
        self.run("mkdir -p /run/payload && mount -o ro /dev/vdb /run/payload")
        self.tower.slow_down()

    def property(self, name):
        return self.run(f"systemctl show depthscope --value --property={name}")

    def status(self):
        """What the daemon says of itself, once it does."""
        return self.wait_for_status(lambda s: True, "an answer of the daemon")

    def _ask_status(self):
        """Empty while there is no daemon."""
        answer = self.run("/run/payload/ask status", check=False)
        return json.loads(answer) if answer.startswith("{") else {}

    def wait_for_status(self, condition, what):
        """Until `condition(status)` holds; the status."""
        def ask():
            status = self._ask_status()
            return status if status and condition(status) else None
        try:
            return wait_until(ask, what)
        except Failure as failure:
            raise Failure(f"{failure}; status: {self._ask_status()}")

    def journal(self):
        """Messages of the service since it was started last, one a line."""
        return self.run(f"journalctl --output=cat _SYSTEMD_INVOCATION_ID={self.property('InvocationID')}")

    def screen(self, name="screen"):
        return Picture.read_ppm(self.machine.screendump(name))

    def keep(self, picture, name):
        """A picture as NAME.png among the results."""
        picture.write_png(os.path.join(self._folder, f"{name}.png"))

    def keep_screen(self, name):
        self.keep(self.screen(), name)

    def explain(self):
        """The guest's own view of a failure."""
        return self.run("systemctl --no-pager --lines=0 status depthscope; journalctl --no-pager --boot --unit=depthscope "
                        "--lines=300 | grep -v -e 'no frames' -e 'status=ok' | tail -n 30; "
                        "journalctl --no-pager --boot --dmesg --priority=err --lines=10", check=False)
