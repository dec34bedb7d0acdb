"""Worker processes: the same answers as in one process, whatever happens to them.  No generator is needed."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import psutil
import pytest

from kirigami_studio.foundation import words
from kirigami_studio.foundation.errors import Cancelled
from kirigami_studio.lattice.ratio_field import RatioField
from kirigami_studio.lattice.sheet import Sheet
from kirigami_studio.outlines.silhouettes import load
from kirigami_studio.pipeline import auto_grid, worker
from kirigami_studio.pipeline.pool import Pool, worker_command
from kirigami_studio.pipeline.preview import preview
from kirigami_studio.pipeline.request import Request
from kirigami_studio.pipeline.run import Watch, answers, gains, grid_choice, shared_out
from kirigami_studio.pipeline.tasks import PolishTask, PolishTogether, Task, TaskResult, scored
from kirigami_studio.pipeline.worker import Alive, Assignment, Done, Ready, packed
from tests.refusals import refused

COUNT = 6


@pytest.fixture(scope="module")
def pool() -> Iterator[Pool]:
    made = Pool(2)
    made.start()
    yield made
    made.close()


@pytest.fixture(scope="module")
def request_for_heart() -> Request:
    return Request(load("heart"), grid=(6, 6), k=COUNT, polish=6)


@pytest.fixture(scope="module")
def tasks(request_for_heart: Request) -> list[Task]:
    draw = np.random.default_rng(0)
    sheets = [Sheet(RatioField.from_log10(draw.uniform(-0.4, 0.4, request_for_heart.grid))) for _ in range(COUNT)]
    return [PolishTask(candidate, 6) for candidate in scored(request_for_heart, sheets, 0)]


def never() -> bool:
    return False


def watch() -> Watch:
    return Watch(never, time.perf_counter())


def work_of(pool: Pool) -> Callable[[], float]:
    """The processor seconds of the worker that works least, from now on."""
    processes = [psutil.Process(one.process.pid) for one in pool.workers]

    def seconds() -> list[float]:
        return [sum(process.cpu_times()[:2]) for process in processes]

    begun = seconds()
    return lambda: min(now - before for now, before in zip(seconds(), begun, strict=True))


class WorkWatch(Watch):
    """A budget of the work that is measured, not of the clock."""

    def __init__(self, worked: Callable[[], float], budget: float) -> None:
        super().__init__(never, time.perf_counter(), budget)
        object.__setattr__(self, "worked", worked)

    def expired(self) -> bool:
        return self.worked() >= self.budget


def answered(pool: Pool | None, request: Request, tasks: list[Task]) -> dict[int, TaskResult]:
    reports = list(answers(pool, request, tasks, watch()))
    numbers = [report[0] for report in reports if report is not None]
    assert sorted(numbers) == list(range(len(tasks)))
    return dict(report for report in reports if report is not None)


@pytest.fixture(scope="module")
def expected(request_for_heart: Request, tasks: list[Task]) -> dict[int, TaskResult]:
    """What one process answers."""
    return answered(None, request_for_heart, tasks)


def wait_until_ready(pool: Pool) -> None:
    deadline = time.monotonic() + 240
    while not all(one.ready for one in pool.workers) and time.monotonic() < deadline:
        assert pool.ready or pool.usable
        time.sleep(0.02)
    assert pool.ready


def test_that_a_worker_previews_the_design_that_one_process_does(pool: Pool, request_for_heart: Request) -> None:
    while not pool.ready:
        time.sleep(0.01)
    first, here = (preview(request_for_heart, pool=one) for one in (pool, Pool(0)))
    assert next(first).fit.sheet == next(here).fit.sheet
    first.close()


def test_that_fits_scored_together_are_those_of_one_by_one(
    request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    together = PolishTogether(tuple(tasks)).carry_out(request_for_heart, never)  # type: ignore[arg-type]
    assert together.parts == tuple(expected[place] for place in range(COUNT))
    assert together.evaluations == sum(part.evaluations for part in together.parts)
    assert sum(part.candidate is not None for part in together.parts) > 1


def test_that_workers_give_bit_by_bit_the_answers_of_one_process(
    pool: Pool, request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    assert answered(pool, request_for_heart, tasks) == expected
    assert len(pool.workers) == 2
    assert any(answer.candidate is not None for answer in expected.values())


def test_that_work_waits_for_workers_that_start(
    request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    """The process that starts them is busy with the generator until long after they have."""
    starting = Pool(2)
    try:
        reports = answers(starting, request_for_heart, tasks, watch())
        assert next(reports) is None
        assert not starting.workers[0].ready
        assert all(worker.assignment is not None for worker in starting.workers)
        assert dict(report for report in reports if report is not None) == expected
    finally:
        starting.close()


def test_that_one_that_starts_gets_work_beside_one_that_is_ready(
    request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    starting = Pool(2)
    try:
        starting.start(1)
        wait_until_ready(starting)
        starting.start()
        starting.workers.reverse()  # whichever was started first, the ready one comes first
        reports = answers(starting, request_for_heart, tasks[:2], watch())
        assert next(reports) is None
        assert [(one.ready, one.assignment and one.assignment.number) for one in starting.workers] == [
            (False, 1),
            (True, 0),
        ]
        assert dict(report for report in reports if report is not None) == {place: expected[place] for place in (0, 1)}
    finally:
        starting.close()


@pytest.mark.parametrize(
    ("count", "workers", "sizes"),
    [(0, 2, []), (1, 2, [1]), (4, 1, [4]), (4, 2, [2, 2]), (6, 2, [3, 3]), (10, 2, [2, 3, 2, 3]), (9, 1, [3, 3, 3])],
)
def test_that_workers_get_parts_that_are_as_large(count: int, workers: int, sizes: list[int]) -> None:
    parts = shared_out(range(count), workers)  # type: ignore[arg-type]
    assert [len(part) for part in parts] == sizes
    assert [one for part in parts for one in part] == list(range(count))


def test_that_nobody_waits_for_a_worker_that_starts_to_read(
    request_for_heart: Request, tasks: list[Task], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.pipeline.pool.PIPE_HOLDS", 1)
    starting = Pool(2)
    try:
        reports = answers(starting, request_for_heart, tasks, watch())
        assert next(reports) is None
        assert all(worker.assignment is None for worker in starting.workers)
        assert len([report for report in reports if report is not None]) == COUNT
    finally:
        starting.close()


@pytest.mark.parametrize("survivors", [1, 0])
def test_that_the_work_of_killed_workers_is_done_again(
    pool: Pool, request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult], survivors: int
) -> None:
    pool.start()
    wait_until_ready(pool)
    found: dict[int, TaskResult] = {}
    for report in answers(pool, request_for_heart, tasks, watch()):
        if report is not None:
            found[report[0]] = report[1]
            for one in list(pool.workers)[survivors:] if len(found) == 1 or not survivors else ():
                one.process.kill()
    assert found == expected
    assert pool.usable  # the next run starts new ones


@pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="processes cannot be stopped here")
def test_that_a_stopped_worker_is_given_up_and_its_work_done_again(
    request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    pool = Pool(2, silence=3.0)
    pool.start()
    try:
        wait_until_ready(pool)
        stopped = pool.workers[0]
        stopped.process.send_signal(signal.SIGSTOP)
        assert answered(pool, request_for_heart, tasks) == expected
        assert not stopped.alive and stopped not in pool.workers and len(pool.workers) == 1
    finally:
        pool.close()


def test_that_a_worker_says_that_it_lives_while_it_works(request_for_heart: Request) -> None:
    draw = np.random.default_rng(1)
    large = replace(request_for_heart, grid=(20, 20))
    (candidate,) = scored(large, [Sheet(RatioField.from_log10(draw.uniform(-0.4, 0.4, large.grid)))], 0)
    with subprocess.Popen(worker_command(), stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(packed(Assignment(1, 0, partial(PolishTask(candidate, 30).carry_out, large), "en")))
        process.stdin.flush()
        reports = [pickle.load(process.stdout)]
        while not isinstance(reports[-1], Done):
            reports.append(pickle.load(process.stdout))
        process.stdin.close()
    assert isinstance(reports[0], Ready) and all(isinstance(one, Alive) for one in reports[1:-1]) and len(reports) > 2


@pytest.mark.parametrize("command", [["no-such-program-anywhere"], [sys.executable, "-c", "raise SystemExit(3)"]])
def test_that_workers_which_cannot_start_are_told_once_and_done_without(
    command: list[str],
    request_for_heart: Request,
    tasks: list[Task],
    expected: dict[int, TaskResult],
    caplog: pytest.LogCaptureFixture,
) -> None:
    broken = Pool(2, command)
    assert answered(broken, request_for_heart, tasks) == expected
    assert answered(broken, request_for_heart, tasks) == expected
    assert [record.getMessage().split(":")[0] for record in caplog.records] == ["polishing goes on in one process"]
    assert not broken.usable
    broken.close()


def test_that_one_core_is_left_to_one_process(request_for_heart: Request) -> None:
    assert not gains(Pool(1), request_for_heart)
    assert not gains(Pool(2), Request(load("heart"), k=2, polish=5)), "too little work to start processes for"
    assert gains(Pool(2), Request(load("heart"), k=32, polish=15))


def test_that_leaving_a_batch_stops_its_workers_within_a_step_and_keeps_the_pool(
    pool: Pool, request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    pool.start()
    wait_until_ready(pool)
    long = Request(request_for_heart.target, grid=(24, 24), k=2, polish=200)
    sheet = Sheet(RatioField.from_log10(np.random.default_rng(3).uniform(-0.9, 0.9, (24, 24))))
    slow = [PolishTask(candidate, 200) for candidate in scored(long, [sheet, sheet], 0)]
    worked = work_of(pool)
    for report in answers(pool, long, slow, watch()):
        assert report is None, "a fit of 200 steps at 24 x 24 cannot be over by now"
        if worked() > 0.1:
            break
    left = worked()
    while any(one.assignment is not None for one in pool.workers):
        assert pool.ready
        assert worked() - left < 5.0, "the fit goes on"
        time.sleep(0.005)
    assert answered(pool, request_for_heart, tasks) == expected


def test_that_a_budget_brings_the_best_so_far_of_fits_under_way(
    pool: Pool, request_for_heart: Request, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kirigami_studio.pipeline.run.GRACE", 120.0)  # a step takes long on a busy machine
    pool.start()
    wait_until_ready(pool)
    long = Request(request_for_heart.target, grid=(24, 24), k=3, polish=200)
    draw = np.random.default_rng(3)
    sheets = [Sheet(RatioField.from_log10(draw.uniform(-0.5, 0.5, (24, 24)))) for _ in range(3)]
    slow = [PolishTask(candidate, 200) for candidate in scored(long, sheets, 0)]
    reports = [report for report in answers(pool, long, slow, WorkWatch(work_of(pool), 0.3)) if report is not None]
    assert sorted(number for number, _ in reports) == [0, 1]
    assert all(answer.candidate is not None for _, answer in reports)


def test_that_an_error_in_a_worker_reaches_the_run(pool: Pool, request_for_heart: Request) -> None:
    pool.start()
    with pytest.raises(AttributeError, match="carry_out"):
        list(answers(pool, request_for_heart, ["not a task"], watch()))  # type: ignore[list-item]
    assert pool.usable


def test_that_workers_do_any_work_beside_this_process(pool: Pool, request: pytest.FixtureRequest) -> None:
    pool.start()
    wait_until_ready(pool)
    request.addfinalizer(lambda: words.choose("en"))
    words.choose("de")
    with pool.beside([os.getpid, words.language, Path.cwd]) as answers:
        assert not pool.ready, "they have begun"
        worker, language, folder = answers()
    assert worker in [one.process.pid for one in pool.workers]
    assert (language, folder) == ("de", Path.cwd())
    assert pool.ready


def where_imported(module: str) -> tuple[int, bool]:
    """The process that does this work, and whether it has a module."""
    return os.getpid(), module in sys.modules


def test_that_workers_import_what_they_are_told_to_and_go_on_where_they_cannot(pool: Pool) -> None:
    pool.start()
    wait_until_ready(pool)
    for module in ("no_such_module_anywhere", "colorsys"):
        pool.prepare(module)
    with pool.beside([partial(where_imported, module) for module in ("colorsys", "antigravity")]) as answers:
        processes, imported = zip(*answers(), strict=True)
    assert set(processes) <= {one.process.pid for one in pool.workers}
    assert imported == (True, False)


class NotInWorkers:
    """Work that other processes cannot read."""

    def __reduce__(self) -> tuple[object, ...]:
        return _only_in, (os.getpid(),)


def _only_in(process: int) -> NotInWorkers:
    if os.getpid() != process:
        raise ImportError
    return NotInWorkers()


def test_that_this_process_does_what_workers_cannot_read(pool: Pool) -> None:
    pool.start()
    wait_until_ready(pool)
    with pool.beside([partial(size_of, NotInWorkers(), b"abc")]) as answers:
        assert answers() == [3]


class SlowToUnpickle:
    """Work that its process has to import something for, as it were."""

    def __reduce__(self) -> tuple[object, ...]:
        return _made_slowly, ()


def _made_slowly() -> SlowToUnpickle:
    time.sleep(0.5)
    return SlowToUnpickle()


def size_of(what: object, content: bytes) -> int:
    return len(content)


def test_that_the_program_does_not_wait_while_a_worker_unpickles(pool: Pool) -> None:
    pool.start()
    wait_until_ready(pool)
    content = bytes(3_000_000)  # more than a pipe takes
    began = time.perf_counter()
    with pool.beside([partial(size_of, SlowToUnpickle(), content)]) as answers:
        given = time.perf_counter() - began
        assert answers() == [len(content)]
    assert given < 0.5 * (time.perf_counter() - began)


def test_that_this_process_does_what_no_worker_is_there_for() -> None:
    asleep = Pool(2)
    with asleep.beside([os.getpid, words.language]) as answers:
        assert answers() == [os.getpid(), "en"]
    assert not asleep.workers, "nobody is started for it"


def test_that_this_process_does_the_work_of_workers_that_die(pool: Pool) -> None:
    pool.start()
    wait_until_ready(pool)
    with pool.beside([partial(time.sleep, 0.01), Path.cwd]) as answers:
        for one in list(pool.workers):
            one.process.kill()
        assert answers() == [None, Path.cwd()]


def written_late(path: Path) -> None:
    """Work that takes a while."""
    time.sleep(0.3)
    path.touch()


def test_that_an_error_in_work_beside_reaches_this_process_once_all_has_ended(pool: Pool, tmp_path: Path) -> None:
    pool.start()
    wait_until_ready(pool)
    works = [partial(int, "no number"), partial(written_late, tmp_path / "late")]
    with pytest.raises(ValueError, match="no number"), pool.beside(works) as answers:
        answers()
    assert (tmp_path / "late").exists()
    assert pool.ready


def test_that_nobody_is_at_work_any_more_after_an_error_in_this_process(pool: Pool, tmp_path: Path) -> None:
    pool.start()
    wait_until_ready(pool)
    with pytest.raises(ZeroDivisionError), pool.beside([partial(written_late, tmp_path / "late")]):
        raise ZeroDivisionError
    assert (tmp_path / "late").exists()
    assert not any(worker.assignment for worker in pool.workers)


def test_that_a_second_run_at_the_same_time_works_by_itself(
    pool: Pool, request_for_heart: Request, tasks: list[Task], expected: dict[int, TaskResult]
) -> None:
    first = answers(pool, request_for_heart, tasks, watch())
    found = [next(first)]
    assert not pool.ready, "asking must not take the first run's answers"
    assert answered(pool, request_for_heart, tasks) == expected
    found += list(first)
    assert dict(report for report in found if report is not None) == expected


def test_that_a_cancelled_watch_says_how_far_it_came() -> None:
    with refused(Cancelled, "run.stopped_scoring", done=3, total=8) as caught:
        Watch(lambda: True, time.perf_counter()).check("run.stopped_scoring", 3, 8)
    assert (caught.value.code, caught.value.fields) == ("run.stopped_scoring", {"done": 3, "total": 8})


def test_that_closing_the_pool_leaves_no_process(request_for_heart: Request, tasks: list[Task]) -> None:
    short_lived = Pool(2)
    short_lived.start()
    processes = [one.process for one in short_lived.workers]
    answered(short_lived, request_for_heart, tasks)
    short_lived.close()
    assert [process.poll() for process in processes] == [0, 0]


def test_that_a_frozen_program_is_a_worker_by_its_flag() -> None:
    command = [sys.executable, "-m", "kirigami_studio", worker.WORKER_FLAG]
    served = subprocess.run(command, input=b"", capture_output=True, timeout=60, check=False)
    assert (served.returncode, served.stderr) == (0, b"")
    assert served.stdout in (b"", pickle.dumps(Ready()))


def test_that_a_worker_ends_with_its_input_and_loads_neither_torch_nor_qt() -> None:
    ended = subprocess.run(worker_command(), input=b"", capture_output=True, timeout=60, check=False)
    assert ended.returncode == 0
    assert ended.stderr == b""
    probe = "import kirigami_studio.pipeline.worker, sys; print(sorted({'torch', 'PySide6'} & set(sys.modules)))"
    loaded = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, timeout=60, check=True)
    assert loaded.stdout.strip() == "[]"


def test_that_workers_choose_the_grid_that_one_process_chooses_and_that_it_is_remembered(pool, monkeypatch) -> None:
    wait_until_ready(pool)
    request = Request(load("star"), None, polish=0)
    monkeypatch.setattr(auto_grid, "_CHOSEN", {})
    alone = auto_grid.chosen_for(request)
    monkeypatch.setattr(auto_grid, "_CHOSEN", {})
    batches: list[int] = []
    by_workers = pool.answers
    monkeypatch.setattr(pool, "answers", lambda *given: batches.append(len(given[0])) or by_workers(*given))
    assert grid_choice(request, pool) == alone
    assert batches == [auto_grid.TRIED_POSES * int(str(dict(alone.fields)["count"]))]
    assert grid_choice(request, pool) == alone and len(batches) == 1
