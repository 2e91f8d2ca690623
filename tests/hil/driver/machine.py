"""The guest under QEMU: its life, its monitor, and commands run inside it."""
import json
import os
import shlex
import socket
import subprocess
import tempfile
import time


# How long to wait for what must come. Only a run that fails waits for so long; a machine that others use too may well
# take ten times as long as a quiet one.
PATIENCE_S = 600


class Failure(Exception):
    """Something is not as it must be; the message says what."""


class LineSocket:
    """A stream socket read line by line, with time limits."""

    def __init__(self, path):
        end = time.monotonic() + PATIENCE_S
        while True:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            try:
                self._socket.connect(path)
                break
            except OSError:
                self._socket.close()
                if time.monotonic() > end:
                    raise Failure(f"{path}: nobody listens")
                time.sleep(0.05)
        self._pending = b""

    def send(self, text):
        self._socket.sendall(text.encode())

    def line(self):
        end = time.monotonic() + PATIENCE_S
        while b"\n" not in self._pending:
            self._socket.settimeout(max(0.01, end - time.monotonic()))
            try:
                got = self._socket.recv(65536)
            except socket.timeout:
                raise Failure(f"no answer within {PATIENCE_S} s")
            if not got:
                raise Failure("the machine hung up")
            self._pending += got
        line, self._pending = self._pending.split(b"\n", 1)
        return line.decode(errors="replace").rstrip("\r")


class Machine:
    """One run of the guest. `folder` keeps its console log; what it writes to its disk is forgotten."""

    def __init__(self, image, payload, folder):
        self._folder = folder
        # Not below a folder of the build, whose name may be too long for a socket.
        self._sockets = tempfile.TemporaryDirectory(prefix="depthscope-hil-", dir="/tmp")
        qmp, agent = (os.path.join(self._sockets.name, name) for name in ("qmp", "agent"))
        self._process = subprocess.Popen(
            # It must not outlive this program, however that ends.
            ["setpriv", "--pdeathsig", "KILL", "qemu-system-x86_64", "-M", "q35", "-cpu", "qemu64,+ssse3,+sse4.1,+sse4.2,+popcnt",
             "-accel", "tcg,thread=multi,tb-size=512", "-smp", "2", "-m", "2048",
             "-display", "none", "-nic", "none", "-nodefaults",
             "-kernel", f"{image}/vmlinux", "-initrd", f"{image}/initrd",
             "-append", "console=ttyS0 panic=-1 quiet loglevel=1 nokaslr mitigations=off tsc=reliable no_timer_check rw "
                        "systemd.show_status=0",
             "-drive", f"file={image}/root.ext4,format=raw,if=virtio,snapshot=on",
             "-drive", f"file={payload},format=raw,if=virtio,readonly=on",
             "-serial", f"file:{folder}/console.log",
             "-device", "virtio-gpu-pci,xres=1280,yres=720", "-device", "virtio-rng-pci",
             "-device", "virtio-keyboard-pci", "-device", "virtio-serial-pci",
             "-chardev", f"socket,id=agent,path={agent},server=on,wait=off",
             "-device", "virtserialport,chardev=agent,name=depthscope.hil",
             "-qmp", f"unix:{qmp},server=on,wait=off"],
            stdin=subprocess.DEVNULL, stdout=open(f"{folder}/qemu.log", "wb"), stderr=subprocess.STDOUT)
        self._qmp = LineSocket(qmp)
        self._qmp.line()  # greeting
        self.qmp("qmp_capabilities")
        self._agent = LineSocket(agent)
        self._owed = 0  # answers of the agent that came too late so far

    def wait_for_boot(self):
        """Until the agent says that it is there."""
        while self._agent.line() != "=ready":
            pass
        self._owed = 0

    def run(self, command, check=True):
        """Runs a shell command as root in the guest; its output. A failure of it is a Failure, unless not `check`."""
        self._agent.send(command + "\n")
        self._owed += 1
        while self._owed > 0:
            lines, line = self._answer()
        output = "\n".join(lines)
        if check and line != "=0":
            raise Failure(f"`{command}` ended with status {line[1:]}:\n{output}")
        return output

    def _answer(self):
        """The next answer of the agent: its lines of output, and its last line."""
        lines = []
        while True:
            line = self._agent.line()
            if line.startswith("="):
                self._owed -= 1
                return lines, line
            lines.append(line[1:])

    def start(self, unit, *words):
        """Starts a program of the guest in the background as UNIT."""
        self.run(f"systemd-run --quiet --collect --unit={unit} {shlex.join(words)}")

    def qmp(self, command, **arguments):
        self._qmp.send(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        while True:
            answer = json.loads(self._qmp.line())
            if "error" in answer:
                raise Failure(f"QMP {command}: {answer['error']['desc']}")
            if "return" in answer:
                return answer["return"]

    def screendump(self, name="screen"):
        """What the monitor shows, as a file."""
        path = f"{self._folder}/{name}.ppm"
        self.qmp("screendump", filename=path)
        return path

    def reboot(self):
        self._agent.send("systemctl reboot\n")
        self.wait_for_boot()

    def power_off(self):
        """Clean shutdown from inside."""
        self._agent.send("systemctl poweroff\n")
        self._process.wait(PATIENCE_S)

    def stop(self):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._sockets.cleanup()


def comes(condition, limit_s):
    """Asks until `condition()` gives something true, and gives that; what it gave last when that takes too long."""
    end = time.monotonic() + limit_s
    while True:
        result = condition()
        if result or time.monotonic() > end:
            return result
        time.sleep(0.2)


def wait_until(condition, what):
    """Asks until `condition()` gives something true, and gives that."""
    result = comes(condition, PATIENCE_S)
    if not result:
        raise Failure(f"waited {PATIENCE_S} s in vain: {what}")
    return result
