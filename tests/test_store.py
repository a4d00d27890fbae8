"""The store: whole results or none, whatever happens to the process that makes them."""

import os
import platform
import shutil
import signal
import subprocess
import sys
import textwrap

import pytest

from industnerf import code_hash, manifest, processor
from industnerf.content import content_digest
from industnerf.store import Cost, Store, store_key

COST = Cost(1.0, 2.0, "cpu")


def make_writer(text="hello"):
    def make(target):
        (target / "deep").mkdir()
        (target / "deep" / "a.txt").write_text(text)
        return COST

    return make


def test_what_is_put_can_be_placed_and_its_cost_is_known(tmp_path):
    store = Store(tmp_path / "store")
    assert not store.has("step", "k")
    store.put("step", "k", make_writer())
    store.checkout("step", "k", tmp_path / "out")
    assert (tmp_path / "out" / "deep" / "a.txt").read_text() == "hello"
    assert store.cost("step", "k") == COST
    assert store.cost("step", "other") is None


def test_an_empty_variable_is_none(monkeypatch):
    """`INDUSTNERF_STORE=` in .industnerf.env would make the repository itself the store."""
    monkeypatch.setenv("INDUSTNERF_STORE", "")
    assert Store.from_environment().root.name == ".store"


def test_a_placed_result_replaces_what_was_there(tmp_path):
    store = Store(tmp_path / "store")
    store.put("step", "k", make_writer())
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "stale").write_text("")
    store.checkout("step", "k", tmp_path / "out")
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["deep"]


def test_results_are_read_only(tmp_path):
    store = Store(tmp_path)
    store.put("step", "k", make_writer())
    assert (store.result_path("step", "k") / "deep" / "a.txt").stat().st_mode & 0o222 == 0


def unlink(path):
    path.unlink()


def write_through(path):
    """What root can do to a read-only file, here or through a link elsewhere."""
    path.chmod(0o644)
    path.write_text("HELLO")
    path.chmod(0o444)


def replace_by_link(path):
    path.unlink()
    path.symlink_to("nowhere")


DAMAGE = {
    "a lost file": lambda entry: unlink(entry / "out/deep/a.txt"),
    "a lost folder": lambda entry: shutil.rmtree(entry / "out"),
    "a changed file": lambda entry: write_through(entry / "out/deep/a.txt"),
    "a file too many": lambda entry: (entry / "out/b.txt").touch(),
    "a lost manifest": lambda entry: unlink(entry / "manifest.json"),
    "a torn manifest": lambda entry: write_through(entry / "manifest.json"),
    "a link to nowhere": lambda entry: replace_by_link(entry / "out/deep/a.txt"),
    "a lost cost": lambda entry: unlink(entry / "cost.json"),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_result_is_set_aside_and_made_anew(tmp_path, damage, capfd):
    store = Store(tmp_path / "store")
    store.put("step", "k", make_writer())
    damage(store.root / "step/k")
    assert not store.has("step", "k")
    (aside,) = store.root.glob("step/.damaged-k-*")
    assert f"a damaged result is set aside and made anew: {aside}: it " in capfd.readouterr().err
    store.put("step", "k", make_writer())
    assert (store.result_path("step", "k") / "deep/a.txt").read_text() == "hello"


def test_a_damaged_result_does_not_block_put(tmp_path):
    """Another process, or the doctor, may look away between the question and the rename."""
    store = Store(tmp_path)
    (tmp_path / "step/k").mkdir(parents=True)
    (tmp_path / "step/k/cost.json").write_text("{}")
    store.put("step", "k", make_writer())
    assert store.has("step", "k")
    assert len(list(tmp_path.glob("step/.damaged-k-*"))) == 1


def test_what_another_process_made_anew_meanwhile_is_not_set_aside(tmp_path, monkeypatch):
    store = Store(tmp_path)
    store.put("step", "k", make_writer())
    unlink(tmp_path / "step/k/out/deep/a.txt")

    def find_damage(entry):
        damage = manifest.find_damage(entry)
        monkeypatch.undo()
        store.put("step", "k", make_writer())
        return damage

    monkeypatch.setattr("industnerf.store.find_damage", find_damage)
    assert store.has("step", "k")
    assert (tmp_path / "step/k/out/deep/a.txt").exists()


def test_a_write_through_a_placed_file_is_noticed(tmp_path):
    """Where the disk has no clones it is a link; where it has, the result is not touched."""
    store = Store(tmp_path / "store")
    store.put("step", "k", make_writer())
    store.checkout("step", "k", tmp_path / "out")
    write_through(tmp_path / "out/deep/a.txt")
    stored = store.result_path("step", "k") / "deep/a.txt"
    assert stored.read_text() == "hello" or not store.has("step", "k")


def test_a_result_of_other_times_is_whole_if_its_bytes_are(tmp_path):
    """A store that was copied without its times is no damage."""
    store = Store(tmp_path)
    store.put("step", "k", make_writer())
    os.utime(store.result_path("step", "k") / "deep/a.txt", (0, 0))
    assert store.has("step", "k")


def test_the_first_of_two_workers_wins(tmp_path):
    store = Store(tmp_path)
    store.put("step", "k", make_writer("first"))
    store.put("step", "k", make_writer("second"))
    assert (store.result_path("step", "k") / "deep" / "a.txt").read_text() == "first"
    assert [p.name for p in (tmp_path / "step").iterdir()] == ["k"]


def test_a_failed_make_leaves_nothing(tmp_path):
    def fail(target):
        (target / "half").write_text("")
        raise ValueError("no")

    store = Store(tmp_path)
    with pytest.raises(ValueError, match="no"):
        store.put("step", "k", fail)
    assert not store.has("step", "k")
    assert list((tmp_path / "step").iterdir()) == []


def test_a_full_disk_is_an_error_not_a_result(tmp_path):
    def fail(target):
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        Store(tmp_path).put("step", "k", fail)


def test_sigkill_while_making_leaves_no_result(tmp_path):
    script = textwrap.dedent("""
        import os, signal, sys
        from pathlib import Path
        from industnerf.store import Store

        def die(target):
            (target / "half").write_text("x")
            os.kill(os.getpid(), signal.SIGKILL)

        Store(Path(sys.argv[1])).put("step", "k", die)
    """)
    ended = subprocess.run([sys.executable, "-c", script, str(tmp_path)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert not Store(tmp_path).has("step", "k")


def test_a_key_depends_on_settings_code_and_content(tmp_path):
    file = tmp_path / "a"
    file.write_text("1")

    def key(stage="s", settings=1, module="industnerf.seeds"):
        return store_key(stage, settings, (module,), [file])

    first = key()
    assert key() == first
    others = [key(stage="t"), key(settings=2), key(module="industnerf.errors")]
    file.write_text("2")
    others.append(key())
    assert len({first, *others}) == 5


def test_an_upgrade_changes_the_keys_of_what_imports_the_library_and_no_others(
    tmp_path, monkeypatch
):
    def keys():
        code_hash.library_versions.cache_clear()
        modules = ("industnerf.methods.atlasnet", "industnerf.methods.hull", "industnerf.seeds")
        return [store_key("s", 1, (module,), []) for module in modules]

    def upgrade(**versions):
        installed = code_hash.version
        monkeypatch.setattr(
            code_hash, "version", lambda name: versions.get(name) or installed(name)
        )

    atlasnet, hull, seeds = keys()
    upgrade(torch="99.0")
    upgraded = keys()
    assert upgraded[0] != atlasnet
    assert upgraded[1:] == [hull, seeds]
    upgrade(torch="99.0+cu130")  # a build for GPUs; a processor is in no key either
    assert keys() == upgraded
    upgrade(scipy="99.0")
    assert keys()[1] != hull
    assert keys()[2] == seeds
    monkeypatch.undo()
    code_hash.library_versions.cache_clear()


def test_a_result_says_with_what_it_was_made(tmp_path, monkeypatch):
    store = Store(tmp_path)
    monkeypatch.setattr(processor, "model", lambda: "Some CPU")
    store.put("step", "k", make_writer(), {"torch": "2.0+cpu"})
    origin = store.origin("step", "k")
    assert (origin.libraries, origin.processor) == ({"torch": "2.0+cpu"}, "Some CPU")
    assert (origin.python, origin.isa) == (platform.python_version(), processor.isa())
    assert store.origin("step", "other") is None


def test_a_digest_does_not_depend_on_where_or_when(tmp_path):
    for name in ("here", "there"):
        (tmp_path / name / "views" / "b").mkdir(parents=True)
        (tmp_path / name / "views" / "b" / "x").write_text("1")
    os.utime(tmp_path / "here" / "views" / "b" / "x", (0, 0))
    here, there = (content_digest([tmp_path / name / "views"]) for name in ("here", "there"))
    assert here == there
    (tmp_path / "there" / "views" / "b" / "x").rename(tmp_path / "there" / "views" / "b" / "y")
    assert content_digest([tmp_path / "there" / "views"]) != here


def test_names_that_are_not_utf8_are_told_apart(tmp_path):
    files = [tmp_path / os.fsdecode(name) for name in (b"caf\xe8.stl", b"caf\xe9.stl")]
    for file in files:
        file.write_text("solid")
    assert content_digest(files[:1]) != content_digest(files[1:])
