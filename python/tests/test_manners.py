"""Bad input, interruption, threads, pickling and progress."""

from __future__ import annotations

import copy
import os
import pickle
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import furrow

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize("name", [name for name, _ in furrow.parameter_names()])
@pytest.mark.parametrize(
    "value",
    [NAN, INF, -INF, 1e309, 10**400, True, None, [1.0], {}, "x", "", "a\0b", "∞", np.zeros(3), object(), 2 + 1j, b"2"],
    ids=repr,
)
def test_no_parameter_takes_nonsense(name, value):
    if name == "contact" and value is True:
        assert furrow.Cell(2.0, contact=True).contact is True
        return
    if name == "shell_profile" and value is None:
        assert furrow.Cell(2.0, shell_profile=None).shell_profile is None
        return
    with pytest.raises(furrow.InputError) as refused:
        furrow.Cell(**{"r0": 2.0, name: value})
    error = refused.value
    assert error.field is not None and error.allowed and error.source == "furrow"
    assert str(error).startswith("furrow: ")


def test_an_error_says_what_was_given_and_what_is_allowed():
    with pytest.raises(furrow.InputError) as refused:
        furrow.Cell(r0=2, epsilon=1.5)
    error = refused.value
    assert (error.field, error.value, error.allowed) == ("epsilon", 1.5, "above 0 and below 1")
    assert isinstance(error, ValueError)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.field, again.allowed) == (str(error), error.field, error.allowed)
    with pytest.raises(furrow.InputError, match="did you mean epsilon") as refused:
        furrow.Cell(r0=2, epsilom=0.8)
    assert refused.value.value in ("epsilom", '"epsilom"')
    with pytest.raises(furrow.InputError, match="amplitude"):
        furrow.Cell(r0=2, cue="kappa:u0=0.4,omega=0.1,amplitude=x")
    with pytest.raises(furrow.InputError, match="gao2026"):
        furrow.Cell(r0=2, preset="gao")
    with pytest.raises(TypeError):
        furrow.Cell()


@pytest.mark.parametrize(
    "call",
    [
        lambda: furrow.Cell(2, cue=3),
        lambda: furrow.Cell(2, cue="a\0"),
        lambda: furrow.Cell(2, cue="kappa:" * 10_000),
        lambda: furrow.Cell(2, config="nowhere.ron"),
        lambda: furrow.Cell(2, config="a\0b"),
        lambda: furrow.Cell(2, lineage=7),
        lambda: furrow.Cell(2, preset=None),
        lambda: furrow.Cell("17 parsecs"),
        lambda: furrow.Cell(2).divide(-1),
        lambda: furrow.Cell(2).divide(2**64),
        lambda: furrow.Cell(2).divide(1.5),
        lambda: furrow.Cell(2).divide(True),
        lambda: furrow.Cell(2).divide(replicates=0),
        lambda: furrow.Cell(2).divide(replicates=10**9),
        lambda: furrow.Cell(2).divide(replicates=2, threads=0),
        lambda: furrow.Cell(2).divide(replicates=2, frames=True),
        lambda: furrow.Cell(2).divide(frames=NAN),
        lambda: furrow.Cell(2).divide(frames=-1.0),
        lambda: furrow.Cell(2).divide(frames=1e-12),
        lambda: furrow.Cell(2).divide(frames="x"),
        lambda: furrow.Cell(2).divide(frames=True, places=0),
        lambda: furrow.Cell(2).divide(places=3),
        lambda: furrow.Cell(2, xi_s=1e9).divide(),
        lambda: furrow.Cell(2, stages=1).divide(),
        lambda: furrow.Cell(2, xi_ratio=-1e300, xi_s=-1e300).divide(),
        lambda: furrow.Cell(2, xi_s=-1e9).steady(),
        lambda: furrow.Cell(2).pitchfork(xi_max=NAN),
        lambda: furrow.Cell(2).pitchfork(xi_max=-1),
        lambda: furrow.Cell(2).pitchfork(xi_max="x"),
        lambda: furrow.Cell(2).branch(max_step=0),
        lambda: furrow.Cell(2).branch(xi_max=INF),
        lambda: furrow.tree("nowhere.ron"),
        lambda: furrow.tree("a\0b"),
        lambda: furrow.tree("Lineage("),
        lambda: furrow.tree(cue="germlnie"),
        lambda: furrow.scenarios(cues="germline"),
        lambda: furrow.scenarios(cues=["none", "none"]),
        lambda: furrow.scenarios(cues=["none"], cue="none"),
        lambda: furrow.scenarios(cues=["none"], constants="x.csv"),
        lambda: furrow.tree_ensemble(constants="nowhere.csv"),
        lambda: furrow.tree(seed=-1),
        lambda: furrow.tree(epsilon=NAN),
        lambda: furrow.tree(threads=10**6),
        lambda: furrow.read_tree("nowhere.json"),
        lambda: furrow.sweep(),
        lambda: furrow.sweep("nowhere.ron"),
        lambda: furrow.sweep("nowhere.ron", axes={"r0": [2]}),
        lambda: furrow.sweep(axes=[2]),
        lambda: furrow.sweep(axes={"r0": []}),
        lambda: furrow.sweep(axes={"r0": "2"}),
        lambda: furrow.sweep(axes={"r0": [NAN]}),
        lambda: furrow.sweep(axes={"r0": [-1]}),
        lambda: furrow.sweep(axes={"r0": [None]}),
        lambda: furrow.sweep(axes={"r0": [True]}),
        lambda: furrow.sweep(axes={"r0": [10**400]}),
        lambda: furrow.sweep(axes={1: [2]}),
        lambda: furrow.sweep(axes={"": [2]}),
        lambda: furrow.sweep(axes={"r0": [2]}, kind="divisions"),
        lambda: furrow.sweep(axes={"r0": range(100_000), "epsilon": range(100_000)}),
        lambda: furrow.Memo(r0_step=2.0),
        lambda: furrow.Memo(r0_step=NAN),
        lambda: furrow.Memo(__file__),
        lambda: furrow.compare.volumes("nowhere.csv"),
        lambda: furrow.compare.volumes(voxel=-1),
        lambda: furrow.compare.counts(3),
        lambda: furrow.calibrate(None),
        lambda: furrow.Memo(3),
        lambda: furrow.Memo(r0_step="x"),
        lambda: furrow.use_store(3),
        lambda: furrow.Cell(2).divide(memo="cache"),
        lambda: furrow.tree(memo="cache"),
        lambda: furrow.Cell(2).phase("r0", 1, 2, xi_s=20),
        lambda: furrow.Cell(2).phase("r0", 1, 2, xi_s=(5, 10, 15)),
        lambda: furrow.Cell(2).branch("30"),
        lambda: furrow.Cell(2).branch(True),
        lambda: furrow.Cell(2).boundary("r0", 1.9, 2.0, folds="no"),
        lambda: furrow.Cell(2, R0=3),
        lambda: furrow.Cell(2, eps=0.8, epsilon=0.9),
        lambda: furrow.Cell(2).replace(eps=0.8, epsilon=0.9),
        lambda: furrow.fit.activity(range=4),
        lambda: furrow.fit.activity(range=("a", "b")),
        lambda: furrow.polarity(amplitude="x"),
        lambda: furrow.polarity(par="k_ap=.25"),
        lambda: furrow.solve("epsilon", chi=0.4, r0=2, range=3),
        lambda: furrow.solve("eps", chi=0.4, r0=2, epsilon=0.8),
        lambda: furrow.compare.volumes(bins=3),
        lambda: furrow.compare.volumes({"embryo": ["1"], "cell": ["AB"], "volume": [1.0]}, unit=3),
        lambda: furrow.tree(dynamics="no"),
        lambda: furrow.scenarios(dynamics=1),
        lambda: furrow.test({"mother": ["P0"], "chi": [0.1]}, ["none"], folded="no"),
        lambda: furrow.test({"mother": ["P0"], "chi": [0.1]}, ["none"], shard=(1, 2, 3)),
    ],
)
def test_bad_arguments_are_refused(call):
    with pytest.raises(furrow.InputError):
        call()


def test_good_input_that_nothing_comes_of():
    with pytest.raises(furrow.NoOutcome, match="no pitchfork for xi_s up to 5"):
        furrow.Cell(2).pitchfork(xi_max=5)
    with pytest.raises(furrow.NoOutcome, match="breaks the mirror symmetry"):
        furrow.Cell(2, cue="germline").pitchfork()
    with pytest.raises(furrow.NoOutcome):
        furrow.Cell(2, t_max=0.01).divide(memo=furrow.Memo())
    assert issubclass(furrow.NoOutcome, RuntimeError)


def test_an_operating_system_that_refuses(tmp_path):
    (tmp_path / "out").write_text("a file in the way")
    with pytest.raises((OSError, furrow.InputError)):
        furrow.sweep(axes={"r0": [1.5]}, out=tmp_path / "out")


#: A lineage that takes long.
LARGE = '(name: "S", founders: [(name: "S", r0: "192um")], limits: (max_cells: 200000, max_depth: 60))'

#: Ctrl-C is heard also where the tests themselves run in the background.
INTERRUPTED = """
import furrow, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
memo = furrow.Memo()
told = []
def progress(done, of):
    if done > 0 and not told:
        told.append(done)
        print("busy", flush=True)
try:
    {call}
except furrow.Interrupted as error:
    assert isinstance(error, KeyboardInterrupt)
    print("stopped", error.solved, len(memo), flush=True)
except KeyboardInterrupt:
    print("stopped between", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals are others there")
@pytest.mark.parametrize(
    ("call", "keeps"),
    [
        ("furrow.sweep(axes={'r0': [1.8 + 0.001 * k for k in range(20000)]}, memo=memo, progress=progress)", True),
        (f"furrow.tree({LARGE!r}, memo=memo, dynamics=True, progress=progress)", True),
        ("furrow.Cell(2.2).divide(replicates=20000, memo=memo, progress=progress)", True),
        (
            "furrow.sweep(axes={'epsilon': [0.6 + 1e-5 * k for k in range(20000)]}, kind='pitchfork', r0=2.2, progress=progress)",
            False,
        ),
    ],
)
def test_ctrl_c_stops_and_what_was_solved_is_kept(call, keeps):
    command = [sys.executable, "-c", INTERRUPTED.format(call=call)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        assert run.stdout.readline() == "busy\n"
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=120)
    assert run.returncode == 0, err
    word, solved, known = out.split()
    assert word == "stopped" and int(known) >= int(solved)
    # Shapes are not kept, and the message does not claim that they are.
    assert (int(solved) > 0) == keeps


def test_other_threads_go_on_while_one_solves():
    steps = 0
    done = threading.Event()

    def solve() -> None:
        for k in range(10):
            furrow.Cell(2.5 + 0.01 * k).divide(memo=furrow.Memo())
        done.set()

    worker = threading.Thread(target=solve)
    worker.start()
    # Were the lock held, this thread would get a turn between two divisions and not within one.
    while not done.wait(0.001):
        steps += 1
    worker.join()
    assert steps > 20


def test_threads_share_a_memo_and_results_do_not_depend_on_them():
    cells = [furrow.Cell(2.2 + 0.05 * (k % 10), cue="germline") for k in range(40)]
    memo = furrow.Memo()
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(lambda cell: cell.divide(memo=memo), cells))
    assert len(memo) == 10
    assert [d.chi for d in together] == [cell.divide(memo=furrow.Memo()).chi for cell in cells[:10]] * 4
    one = furrow.tree(memo=furrow.Memo(), threads=1)
    assert furrow.tree(memo=furrow.Memo(), threads=7) == one


def test_everything_can_be_pickled(tmp_path):
    cell = furrow.Cell(2.2, cue="germline", w=0.15, intervals=64)
    division = cell.divide(frames=0.5)
    branch, steady = furrow.Cell(2).branch(xi_max=24), furrow.Cell(2, xi_s=12).steady()
    sweep, tree = furrow.sweep(axes={"r0": [2.0]}), furrow.tree()
    for copied in (lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy):
        assert copied(cell) == cell
        again = copied(division)
        assert again == division and again.frames[1].contour["c_uu"].tolist() == division.frames[1].contour["c_uu"].tolist()
        assert copied(branch)["symmetric"].H.tolist() == branch["symmetric"].H.tolist()
        assert copied(steady).growth_rates.tolist() == steady.growth_rates.tolist()
        assert copied(furrow.Cell(2).pitchfork()) == furrow.Cell(2).pitchfork()
        assert copied(sweep).csv == sweep.csv and copied(tree) == tree
        scenarios = copied(furrow.scenarios(cues=["none"]))
        assert list(scenarios) == ["c_elegans-none"]
        replicates = copied(furrow.Cell(2).divide(replicates=2))
        assert len(replicates) == 2
        assert str(copied(furrow.Memo(tmp_path)).store) == str(tmp_path)
        assert copied(furrow.Interrupted(3)).solved == 3
        assert copied(furrow.compare.volumes()).mothers == furrow.compare.volumes().mothers


def test_progress_is_told(memo):
    told = []
    furrow.sweep(axes={"r0": np.linspace(2.0, 3.0, 60)}, memo=memo, progress=lambda done, of: told.append((done, of)))
    assert all(0 <= done <= of and of > 0 for done, of in told) and told[-1] == (60, 60)
    # So are runs that are too short to be told of while they last.
    for short in (
        lambda tell: furrow.Cell(2.2).divide(replicates=2, memo=memo, progress=tell),
        lambda tell: furrow.tree('(name: "S", founders: [(name: "S", r0: 2.4)])', memo=memo, progress=tell),
    ):
        told.clear()
        short(lambda done, of: told.append((done, of)))
        assert told[-1][0] == told[-1][1] > 0

    def fail(done: int, of: int) -> None:
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        furrow.sweep(axes={"r0": np.linspace(3.0, 4.0, 60)}, memo=memo, progress=fail)
    # The divisions solved until then are kept.
    assert len(memo) > 60


def test_progress_is_a_bar_where_tqdm_is_installed(memo, capsys, monkeypatch):
    tqdm = pytest.importorskip("tqdm.auto").tqdm

    def at_once(**options):
        # Short runs have no bar; here they do.
        assert options.pop("delay") > 0
        return tqdm(**options)

    monkeypatch.setattr("tqdm.auto.tqdm", at_once)
    furrow.sweep(axes={"r0": np.linspace(2.0, 3.0, 60)}, memo=memo, progress=True)
    assert "points" in capsys.readouterr().err
    furrow.sweep(axes={"r0": np.linspace(2.0, 3.0, 60)}, memo=furrow.Memo(), progress=False)
    assert capsys.readouterr().err == ""


def test_versions():
    assert furrow.__version__ and furrow.solver_version >= 1
    assert set(furrow.presets()) == {"gao2026", "gao2026-thresholds", "sulston1983"}
    for name in furrow.__all__:
        assert getattr(furrow, name) is not None


FORK = """
import os, signal, sys, threading, time
import furrow

memo = furrow.memo()
radii = [1.9 + 0.0007 * k for k in range(4000)]
worker = threading.Thread(target=lambda: furrow.sweep(axes={"r0": radii}, intervals=32), daemon=True)
worker.start()
while len(memo) < 2:
    time.sleep(0.001)
for k in range(20):
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        known = len(furrow.memo())
        # A division that a thread of the parent may be solving, and one of an object of the parent.
        chi = furrow.Cell(radii[len(radii) - 1 - k], intervals=32).divide(memo=memo if k % 2 else None).chi
        os._exit(0 if known == 0 and chi is not None else 3)
    if os.waitpid(child, 0)[1] != 0:
        print("child", k, "failed or hung")
        os._exit(1)
    time.sleep(0.01)
os._exit(0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_the_child_of_a_fork_computes_while_threads_of_the_parent_do():
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", FORK], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def test_messages_name_arguments():
    table = {"embryo": ["1", "1"], "cell": ["AB", "P1"], "volume_um3": [14000.0, 9500.0]}
    for call, reason in (
        (lambda: furrow.Cell(2, elements=64), "elements = 64: must be given with modes above 0 alone: the solver"),
        (lambda: furrow.compare.volumes(table, voxel=0.1), "furrow: voxel = (given): must be left out"),
        (lambda: furrow.compare.volumes({**table, "mother": ["a", "b"]}, voxel={"3": 0.1}), "voxel"),
        (lambda: furrow.test(table, ["none"], class_columns=["cell"]), "class_columns"),
        (lambda: furrow.compare.lifetimes({"cell": ["AB"], "lifetime_min": [1.0]}, frame_minutes=2), "furrow: frame_minutes ="),
        (lambda: furrow.Cell(2, law="nowhere.ron"), "nowhere.ron"),
    ):
        with pytest.raises(furrow.InputError) as refused:
            call()
        assert reason in str(refused.value) and "--" not in str(refused.value)
    with pytest.raises(furrow.NoOutcome, match="set modes=0"):
        furrow.Cell(2, modes=2, cue="regulator:none,turnover=10,diffusion=1,activity=0.3").divide()
