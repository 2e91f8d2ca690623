"""The guest under QEMU: its life, its monitor, and commands run inside it."""
import json
import os
import shlex
import socket
import subprocess
import tempfile
import time


class Failure(Exception):
    """Something is not as it must be; the message says what."""


class LineSocket:
    """A stream socket read line by line, with time limits."""

    def __init__(self, path, limit_s=30):
        end = time.monotonic() + limit_s
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

    def line(self, limit_s):
        end = time.monotonic() + limit_s
        while b"\n" not in self._pending:
            self._socket.settimeout(max(0.01, end - time.monotonic()))
            try:
                got = self._socket.recv(65536)
            except socket.timeout:
                raise Failure(f"no answer within {limit_s} s")
            if not got:
                raise Failure("the machine hung up")
            self._pending += got
        line, self._pending = self._pending.split(b"\n", 1)
        return line.decode(errors="replace").rstrip("\r")


class Machine:
    """One run of the guest. `folder` keeps its console log; what it writes to its disk is forgotten."""

    def __init__(self, image, payload, folder):
        self._folder = folder
        self._sockets = tempfile.TemporaryDirectory(prefix="depthscope-hil-")
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
        self._qmp.line(30)  # greeting
        self.qmp("qmp_capabilities")
        self._agent = LineSocket(agent)

    def wait_for_boot(self, limit_s=240):
        """Until the agent says that it is there."""
        while self._agent.line(limit_s) != "=ready":
            pass

    def run(self, command, limit_s=120, check=True):
        """Runs a shell command as root in the guest; its output. A failure of it is a Failure, unless not `check`."""
        self._agent.send(command + "\n")
        lines = []
        while True:
            line = self._agent.line(limit_s)
            if line.startswith("="):
                break
            lines.append(line[1:])
        output = "\n".join(lines)
        if check and line != "=0":
            raise Failure(f"`{command}` ended with status {line[1:]}:\n{output}")
        return output

    def start(self, unit, *words):
        """Starts a program of the guest in the background as UNIT."""
        self.run(f"systemd-run --quiet --collect --unit={unit} {shlex.join(words)}")

    def qmp(self, command, **arguments):
        self._qmp.send(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        while True:
            answer = json.loads(self._qmp.line(60))
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

    def power_off(self, limit_s=90):
        """Clean shutdown from inside."""
        self._agent.send("systemctl poweroff\n")
        self._process.wait(limit_s)

    def stop(self):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._sockets.cleanup()


def wait_until(condition, limit_s, what):
    """Asks until `condition()` gives something true, and gives that."""
    end = time.monotonic() + limit_s
    while True:
        result = condition()
        if result:
            return result
        if time.monotonic() > end:
            raise Failure(f"waited {limit_s} s in vain: {what}")
        time.sleep(0.2)
