"""Children of a process that has used the library: forked and spawned, as `multiprocessing` makes them."""

import array
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import rototoon
from rototoon import Session, Strokes, fit_strokes

LONG = 120.0
"""Seconds after which a child counts as one that never ends."""


def _tracked(document, folder):
    with Session.from_document(document, folder) as session:
        session.track()
        session.snap()
        return session.document()


def _fitted():
    points = array.array("d", [0, 0, 5, 1, 9, 4, 12, 9])
    return fit_strokes(Strokes(offsets=[0, 4], points=points, closed=[0]), tolerance=0.5)


def _answer(document, folder, answers):
    answers.put(_tracked(document, str(folder)))


@pytest.mark.parametrize("method", sorted({"fork", "spawn"} & set(multiprocessing.get_all_start_methods())))
def test_a_child_gets_the_same_result_after_the_parent_has_tracked(document, folder, method):
    expected = _tracked(document, folder)
    context = multiprocessing.get_context(method)
    answers = context.SimpleQueue()
    children = [context.Process(target=_answer, args=(document, folder, answers)) for _ in range(2)]
    for child in children:
        child.start()
    found = [_wait(child, answers) for child in children]
    assert found == [expected, expected]


def _wait(child, answers):
    end = time.monotonic() + LONG
    while answers.empty() and time.monotonic() < end and child.exitcode in (None, 0):
        time.sleep(0.02)
    if answers.empty():
        child.kill()
        pytest.fail("the child did not answer")
    return answers.get()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
def test_a_session_goes_on_in_a_forked_child(session):
    """The child has the parent's open session, and edits a copy of it."""
    session.track()
    before = session.document()
    child = os.fork()
    if child == 0:
        # Nothing of pytest may run in the child, so it ends with `_exit`.
        code = 1
        try:
            session.pin("red", 3, 0, (18.0, 7.0))
            code = 0 if session.track().solved == 1 and _fitted() is not None else 2
        finally:
            os._exit(code)
    end = time.monotonic() + LONG
    done, status = 0, 0
    while not done and time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        time.sleep(0.02)
    if not done:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    assert done, "the child did not end"
    assert os.waitstatus_to_exitcode(status) == 0
    assert session.document() == before


ENDING = """
import atexit, json, sys, threading, time
# Registered before those of the package, so called after them.
atexit.register(lambda: print("solved at exit:", track(lambda *_: True).solved, flush=True))
from rototoon import Cancelled, Session

folder, began = sys.argv[1], threading.Event()
document = json.loads(sys.stdin.read())

def track(progress):
    with Session.from_document(document, folder) as session:
        return session.track(progress=progress)

def shown(*_):
    began.set()
    time.sleep(0.2)

def work():
    while True:
        try:
            track(shown)
        except Cancelled:
            pass

class Slow:
    def __del__(self, sleep=time.sleep):
        sleep(0.5)

# The dictionary of this module lives as long as the thread.
sys.slow = Slow()
threading.Thread(target=work, daemon=True).start()
assert began.wait(60)
"""
"""A program that ends while a daemon thread tracks. The end is slow, so a callback of the thread comes to its own end while Python ends."""


def test_a_process_ends_well_while_a_daemon_thread_tracks(document, folder):
    environment = {**os.environ, "PYTHONPATH": str(Path(rototoon.__file__).parents[1]), "ROTOTOON_CACHE": "none"}
    command = [sys.executable, "-c", ENDING, str(folder)]
    ended = subprocess.run(command, input=json.dumps(document), capture_output=True, text=True, env=environment, timeout=LONG, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "solved at exit: 4\n", "")
