"""Long work that follows the window's events: what ends it."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def window():
    """What work asks of a window."""
    timers, said = [], []
    manager = SimpleNamespace(
        event_timer_add=lambda *_, **__: timers.append(1) or timers, event_timer_remove=lambda _: timers.pop(), modal_handler_add=lambda _: None
    )
    space = SimpleNamespace(status_text_set=said.append)
    return SimpleNamespace(window_manager=manager, window=None, workspace=space, object=None, timers=timers, said=said)


class Work:
    """An operator that works in steps and then writes in steps; it keeps what it has done."""

    bl_idname, bl_label = "rototoon.work", "Work"

    def begin(self, _context):
        return self.jobs.Stepper(self.steps("step"), "Stepping")

    def finish(self, _context, _work):
        yield from self.steps("written")
        return "done"

    def steps(self, name):
        try:
            for count in range(1, 4):
                self.log.append(f"{name} {count}")
                yield count / 3
        finally:
            self.log.append(f"no more of {name}")

    def report(self, kind, text):
        self.reported.append((*kind, text))


@pytest.fixture
def work(addon, monkeypatch):
    operators = addon("common.operators")
    # A clock that ticks once a look: each slice has one step.
    monkeypatch.setattr(operators, "time", SimpleNamespace(perf_counter=iter(range(1000)).__next__))
    made = type("Made", (Work, operators.Long), {"jobs": addon("common.jobs"), "log": [], "reported": []})()
    monkeypatch.setattr(operators, "SLICE", 1.5)
    return made


def tick(work, window):
    return work.modal(window, SimpleNamespace(type="TIMER", value="NOTHING"))


def hooks():
    return len(bpy.app.handlers.undo_pre), len(bpy.app.handlers.redo_pre)


def undo():
    """What Blender does before it undoes something."""
    for hook in list(bpy.app.handlers.undo_pre):
        hook()


def test_work_that_nothing_disturbs_ends(work, window):
    before = hooks()
    assert work._follow(window) == {"RUNNING_MODAL"} and hooks() == (before[0] + 1, before[1] + 1)
    results = [tick(work, window) for _ in range(12) if not work.reported]
    assert results[-1] == {"FINISHED"} and work.reported == [("INFO", "done")]
    assert hooks() == before and window.timers == [] and window.said[-1] is None


def test_undo_in_another_window_ends_the_work(work, window):
    before = hooks()
    work._follow(window)
    tick(work, window)
    undo()
    assert work.log == ["step 1", "no more of step"], "it has let go of Blender's data before they change"
    assert tick(work, window) == {"CANCELLED"}
    assert work.reported == [("WARNING", "Work: stopped, since something was undone meanwhile")]
    assert hooks() == before and window.timers == [] and window.said[-1] is None


def test_undo_in_another_window_ends_the_writing(work, window):
    work._follow(window)
    while "written 1" not in work.log:
        assert tick(work, window) == {"RUNNING_MODAL"}
    undo()
    assert work.log[-1] == "no more of written" and "written 3" not in work.log
    assert tick(work, window) == {"CANCELLED"}
    assert work.reported[0][0] == "WARNING" and window.timers == []


def test_an_error_that_nobody_foresaw_ends_the_work(work, window, monkeypatch):
    before = hooks()
    monkeypatch.setattr(work, "finish", lambda *_: {}["nothing"], raising=False)
    assert work._follow(window) == {"RUNNING_MODAL"}
    with pytest.raises(KeyError):
        for _ in range(12):
            tick(work, window)
    assert hooks() == before and window.timers == [] and window.said[-1] is None
