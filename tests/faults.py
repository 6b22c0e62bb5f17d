#!/usr/bin/env python3
"""Lets the system fail at every call that a command makes on the user's files.

    python3 tests/faults.py target/x86_64-unknown-linux-gnu/release/rototoon

strace notes the system calls of a command that work on the files in its folder. Then the command runs again for each of
these calls, and this one call fails, is interrupted, or is the moment at which a signal arrives:

    error       EIO, as of a broken disk or a lost network
    full        ENOSPC, a full disk, at calls that write
    read-only   EROFS, at calls that open or rename
    repeat      EINTR, at calls that read, write or open: the program has to repeat them
    kill        SIGKILL, as of a power cut
    end         SIGTERM

After each run

- every input has the same bytes as before,
- every output is complete: it has the bytes of the earlier file or those of a run without faults,
- a run with status 0 has written every output,
- any other status is 1, or that of an end by SIGTERM; the reason is on stderr and names the file whose call failed,
- no temporary file is left, but after SIGKILL and where its removal itself fails,
- the next run succeeds.

Further runs have slow calls, files whose times lie in 1971 and 2100, and eight processes that write the same output. It
needs Linux and strace.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import growth

READS = ["read", "pread64"]
WRITES = ["write", "pwrite64"]
OPENS = ["openat"]
NAMES = ["rename", "renameat", "renameat2", "unlink", "unlinkat", "link", "linkat", "fchmod", "chmod"]
OTHERS = ["fsync", "fdatasync", "statx", "newfstatat", "fstat", "lseek", "getdents64", "readlink", "readlinkat", "mkdir"]
CALLS = [*READS, *WRITES, *OPENS, *NAMES, *OTHERS]

FAULTS = {
    "error": ("error=EIO", CALLS),
    "full": ("error=ENOSPC", [*WRITES, *OPENS, *NAMES, "fsync", "fdatasync"]),
    "read-only": ("error=EROFS", [*OPENS, *NAMES]),
    "repeat": ("error=EINTR", [*READS, *WRITES, *OPENS]),
    "kill": ("signal=KILL", CALLS),
    "end": ("signal=TERM", CALLS),
}
"""What happens at a call, in the words of strace, and at which calls."""

MAY_BE_LEFT = {"unlink", "unlinkat"}
"""Calls whose failure leaves a temporary file."""

EARLIER = b"what was here before\n"
FRAMES = 3


@dataclass
class Command:
    """A command of the program and the files that it writes."""

    words: list[str]
    outputs: list[str]
    good: dict[str, bytes] = field(default_factory=dict)
    """The outputs of a run without faults."""


@dataclass
class Fault:
    """A fault at one system call."""

    kind: str
    call: str
    number: int
    """Which of such calls of a thread it is, from 1."""
    path: str
    """The file that the call is about. "." is the folder."""
    alone: bool
    """Whether strace looks at calls with this file only, and counts no others."""
    main: bool
    """Whether it is a call of the main thread, which also prints errors."""
    also: frozenset[str | None]
    """The files of all calls with this number. strace counts the calls of each thread from 1."""

    def strace(self, folder: Path) -> list[str]:
        """The arguments of strace."""
        alone = ["-P", str(folder / self.path)] if self.alone else []
        inject = f"inject={self.call}:{FAULTS[self.kind][0]}:when={self.number}"
        return ["-o", "/dev/null", *alone, "-e", f"trace={self.call}", "-e", inject]

    def __str__(self) -> str:
        return f"{self.kind} at {self.call} {self.number} ({self.path})"


COMMANDS = [
    Command(["check", "in.json"], []),
    Command(["track", "in.json", "-o", "out.json"], ["out.json"]),
    Command(["snap", "tracked.json", "-o", "out.json"], ["out.json"]),
    Command(["render", "tracked.json", "-o", "r_%d.png", "--what", "overlay"], [f"r_{k}.png" for k in range(FRAMES)]),
    Command(["render", "tracked.json", "-o", "r_%d.exr", "--what", "ids"], [f"r_{k}.exr" for k in range(FRAMES)]),
    *[Command(["export", "tracked.json", "-o", f"out.{kind}"], [f"out.{kind}"]) for kind in ("svg", "nk", "py", "jsx", "fxs", "setting")],
    Command(["import", "in.json", "shapes.svg", "-o", "out.json"], ["out.json"]),
    Command(["fit", "curves.json", "--tolerance", "1", "-o", "out.json"], ["out.json"]),
    Command(["tween", "drawn.json", "-o", "out.json"], ["out.json"]),
    Command(["style", "translate", "clips.json", "--style", "c0", "--motion", "m1", "--content", "c1", "-o", "out.json"],
            ["out.json"]),
]


class Trial:
    """A folder with inputs, and a program that works on them."""

    def __init__(self, program: str, folder: Path) -> None:
        self.program, self.folder = os.path.abspath(program), folder
        self.write_inputs()
        self.inputs = {path.name: self.digest(path) for path in folder.iterdir()}
        self.counts: Counter[str] = Counter()
        self.wrong: list[str] = []

    @staticmethod
    def digest(path: Path) -> str:
        return hashlib.sha256(path.read_bytes()).hexdigest()

    def write_inputs(self) -> None:
        bench = growth.Bench(self.program, self.folder)
        for frame in range(FRAMES):
            growth.png(self.folder / f"f_{frame:03}.png", 96, 64)
        shape = growth.disc(48, 32, 22)
        part = {"name": "disc", "closed": True, "keys": {"0": shape, str(FRAMES - 1): shape}}
        bench.put("in.json", growth.document([part], FRAMES - 1, 96, 64))
        tracks = {str(frame): shape for frame in range(FRAMES)}
        bench.put("tracked.json", growth.document([{**part, "tracks": tracks}], FRAMES - 1, 96, 64))
        bench.put("drawn.json", growth.drawings(4))
        bench.put("curves.json", growth.curve(60))
        bench.put("clips.json", growth.clips(12))
        bench.put("shapes.svg", growth.shapes(3).replace("960 540", "96 64"))

    def run(self, command: Command, strace: list[str] = []) -> subprocess.CompletedProcess:
        before = ["strace", "-f", "-qq", *strace] if strace else []
        return subprocess.run(
            [*before, self.program, *command.words],
            cwd=self.folder,
            capture_output=True,
            env={**os.environ, "RAYON_NUM_THREADS": "1"},
            timeout=120,
        )

    def clean(self) -> None:
        """Removes everything but the inputs."""
        for path in self.folder.iterdir():
            if path.name not in self.inputs:
                path.unlink()

    def prepare(self, command: Command, earlier: bool) -> None:
        """A folder with inputs only, or with earlier files in the places of the outputs."""
        self.clean()
        for name in command.outputs if earlier else []:
            (self.folder / name).write_bytes(EARLIER)

    def learn(self, command: Command) -> None:
        """Runs a command without a fault."""
        self.clean()
        done = self.run(command)
        if done.returncode != 0:
            raise SystemExit(f"{command.words}: {done.returncode} {done.stderr.decode()}")
        command.good = {name: (self.folder / name).read_bytes() for name in command.outputs}

    def faults(self, command: Command) -> list[Fault]:
        """All faults at calls that work on the folder."""
        self.prepare(command, earlier=True)
        with tempfile.NamedTemporaryFile() as log:
            self.run(command, ["-y", "-o", log.name, "-e", f"trace={','.join(CALLS)}"])
            lines = Path(log.name).read_text(errors="replace").splitlines()
        matches = [match.groups() for line in lines if (match := re.match(r"(\d+)\s+(\w+)\((.*)", line))]
        first = matches[0][0]
        counts: Counter[tuple[str, ...]] = Counter()
        found = {}
        met: dict[tuple[str, int], set[str | None]] = {}
        for thread, call, rest in matches:
            path = self.path_of(rest)
            # The names of temporary files are not known beforehand, so their calls are counted with all others.
            alone = path is not None and (path == "." or path in self.inputs or path in command.outputs)
            counts[thread, call, path if alone else ""] += 1
            counts[thread, call, ""] += alone
            number = counts[thread, call, path if alone else ""]
            met.setdefault((call, counts[thread, call, ""]), set()).add(path)
            if path is not None:
                found[call, number, path if alone else ""] = (path, alone, thread == first)
        return [
            Fault(kind, call, number, *rest, also=frozenset(() if rest[1] else met[call, number]))
            for (call, number, _), rest in found.items()
            for kind, (_, calls) in FAULTS.items()
            # A call of another thread with the same number would fail too, such as one that loads the program.
            if call in calls and (rest[1] or None not in met[call, number])
        ]

    def path_of(self, rest: str) -> str | None:
        """The name of the file in the folder that a line of strace is about: the path given, or that of the descriptor."""
        folder = str(self.folder)
        given = re.search(r'"((?:[^"\\]|\\.)*)"', rest.split(" = ")[0])
        by_number = re.match(r"\d+<([^>]*)>", rest)
        if by_number:
            path = by_number.group(1)
        elif given:
            path = os.path.join(folder, given.group(1))
        else:
            return None
        return os.path.basename(path) if path.startswith(folder + "/") else "." if path == folder else None

    def complain(self, command: Command, what: object, reason: str) -> None:
        self.wrong.append(f"{' '.join(command.words)}: {what}: {reason}")
        print("wrong:", self.wrong[-1], file=sys.stderr, flush=True)

    def check_files(self, command: Command, what: object, code: int, may_leave: bool, earlier: bool) -> None:
        """Inputs are as before, and outputs are complete."""
        for name, digest in self.inputs.items():
            if not (self.folder / name).is_file() or self.digest(self.folder / name) != digest:
                self.complain(command, what, f"the input {name} has changed")
        for name, good in command.good.items():
            path = self.folder / name
            found = path.read_bytes() if path.is_file() else None
            fine = found == good or (code != 0 and found == (EARLIER if earlier else None))
            if not fine:
                size = "no file" if found is None else f"{len(found)} bytes"
                self.complain(command, what, f"status {code}, and the output {name} is {size}, expected {len(good)} bytes")
        known = {*self.inputs, *command.outputs}
        left = [path.name for path in self.folder.iterdir() if path.name not in known]
        if left and not may_leave:
            self.complain(command, what, f"files are left: {left}")

    def suffer(self, command: Command, fault: Fault, earlier: bool) -> None:
        """Runs a command with a fault, and looks at what is left."""
        self.prepare(command, earlier)
        try:
            done = self.run(command, fault.strace(self.folder))
        except subprocess.TimeoutExpired:
            return self.complain(command, fault, "it does not end")
        self.counts[fault.kind] += 1
        code, said = done.returncode, done.stderr.decode(errors="replace")
        allowed = {"kill": (0, -9, 137), "end": (0, -15, 143), "repeat": (0,)}.get(fault.kind, (0, 1))
        if code not in allowed:
            self.complain(command, fault, f"status {code}: {said.strip()}")
        # A fault in another thread's write also meets the main thread's first write, which is the error.
        told = fault.main or fault.call not in WRITES
        if code == 1 and told and fault.kind not in ("kill", "end"):
            self.check_reason(command, fault, said)
        self.check_files(command, fault, code, fault.kind == "kill" or fault.call in MAY_BE_LEFT, earlier)

    def check_reason(self, command: Command, fault: Fault, said: str) -> None:
        """The error names the file whose call failed. A temporary file stands for an output."""
        names = [fault.path] if fault.path in self.inputs else [*command.outputs, *fault.also, fault.path]
        if "error: " not in said or not any(name in said for name in names):
            self.complain(command, fault, f"the error does not name the file: {said.strip()}")

    def check_next(self, command: Command, what: object) -> None:
        """The next run succeeds, whatever the run before has left."""
        code = self.run(command).returncode
        if code != 0:
            self.complain(command, what, f"the next run ends with status {code}")
        self.check_files(command, f"after {what}", code, may_leave=True, earlier=False)

    def slow(self, command: Command) -> None:
        """Every call on a file takes 5 ms, as over a network. The result is the same."""
        self.prepare(command, earlier=False)
        calls = ",".join([*READS, *OPENS, *WRITES])
        done = self.run(command, ["-o", "/dev/null", "-e", f"trace={calls}", "-e", f"inject={calls}:delay_enter=5000"])
        self.counts["slow"] += 1
        self.check_files(command, "slow calls", done.returncode, may_leave=False, earlier=False)
        if done.returncode:
            self.complain(command, "slow calls", f"status {done.returncode}")

    def clocks(self, command: Command) -> None:
        """The times of the inputs and of left-over files lie in 1971 and in 2100. The result is the same."""
        for year in (1971, 2100):
            self.prepare(command, earlier=False)
            left = self.folder / ".rototoon-a1B2c3"
            left.write_bytes(b"left")
            moment = (year - 1970) * 365.25 * 86400
            for path in self.folder.iterdir():
                os.utime(path, (moment, moment))
            done = self.run(command)
            self.counts["clock"] += 1
            self.check_files(command, f"files of {year}", done.returncode, may_leave=True, earlier=False)
            if done.returncode:
                self.complain(command, f"files of {year}", f"status {done.returncode}")

    def together(self, command: Command) -> None:
        """Eight processes write the same output."""
        self.prepare(command, earlier=False)
        started = [
            subprocess.Popen([self.program, *command.words], cwd=self.folder, stderr=subprocess.DEVNULL,
                             stdout=subprocess.DEVNULL) for _ in range(8)
        ]
        codes = [each.wait() for each in started]
        self.counts["together"] += len(codes)
        if any(codes):
            self.complain(command, "eight processes", f"status {codes}")
        self.check_files(command, "eight processes", 0, may_leave=False, earlier=False)


def main() -> int:
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    if shutil.which("strace") is None:
        raise SystemExit("strace is missing; install it: apt-get install strace")
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        trial = Trial(sys.argv[1], Path(name).resolve())
        for command in COMMANDS:
            trial.learn(command)
            faults = trial.faults(command)
            for index, fault in enumerate(faults):
                trial.suffer(command, fault, earlier=index % 2 == 0)
                if fault.kind == "kill":
                    trial.check_next(command, fault)
            for more in (trial.slow, trial.clocks, trial.together):
                more(command)
            print(f"{' '.join(command.words)}: {len(faults)} faults", flush=True)
    counts = ", ".join(f"{kind} {count}" for kind, count in trial.counts.items())
    print(f"{sum(trial.counts.values())} runs in {time.monotonic() - start:.0f} s: {counts}; {len(trial.wrong)} wrong")
    return 1 if trial.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
