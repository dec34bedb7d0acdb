"""What is shipped agrees with itself: version, changelog and file names, desktop files, licences, what is left out."""

from __future__ import annotations

import configparser
import importlib.util
import json
import plistlib
import re
import shutil
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from types import ModuleType

import pytest

from kirigami_studio import __version__
from kirigami_studio.cli import main
from kirigami_studio.foundation.licences import CHOSEN, packages
from kirigami_studio.project.store import SUFFIX

MIME = "{http://www.freedesktop.org/standards/shared-mime-info}"


def loaded(name: str, path: Path) -> ModuleType:
    """A module of ``packaging``, which is no package."""
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def packaging(repository: Path) -> Path:
    return repository / "packaging"


@pytest.fixture(scope="module")
def version(packaging: Path) -> ModuleType:
    return loaded("version", packaging / "version.py")


@pytest.fixture(scope="module")
def bundle(version: ModuleType, packaging: Path) -> ModuleType:
    return loaded("bundle", packaging / "bundle.py")


def tree(folder: Path, changelog: str) -> Path:
    """A repository with a version and a changelog alone."""
    (folder / "kirigami_studio").mkdir()
    (folder / "kirigami_studio" / "__init__.py").write_text('"""Ours."""\n\n__version__ = "1.2.0"\n', encoding="utf-8")
    (folder / "CHANGELOG.md").write_text(changelog, encoding="utf-8")
    return folder


def test_that_the_version_is_that_of_the_program(version: ModuleType) -> None:
    assert version.version() == __version__


def test_that_a_released_version_has_the_first_dated_section(version: ModuleType, tmp_path: Path) -> None:
    text = "# Changelog\n\n## UNRELEASED\n\n## 1.2.0 - 2026-12-01\n\n- New.\n\n## 1.1.0 - 2026-11-01\n\n- Old.\n"
    assert version.changes("1.2.0", tree(tmp_path, text)) == ("2026-12-01", "- New.")


@pytest.mark.parametrize(
    ("changelog", "said"),
    [
        ("# Changelog\n\n## UNRELEASED\n\n- New.\n", "needs a section '## 1.2.0 - YYYY-MM-DD'"),
        ("# Changelog\n\n## 1.1.0 - 2026-11-01\n\n- Old.\n", "the first is '## 1.1.0"),
        ("# Changelog\n\n## 1.2.0\n\n- New.\n", "YYYY-MM-DD"),
        ("# Changelog\n\n## 1.2.0 - 2026-12-01\n\n## 1.1.0 - 2026-11-01\n\n- Old.\n", "is empty"),
        ("# Changelog\n\n## UNRELEASED\n\n- Newest.\n\n## 1.2.0 - 2026-12-01\n\n- New.\n", "under UNRELEASED"),
    ],
)
def test_that_a_changelog_that_does_not_agree_is_refused(
    version: ModuleType, tmp_path: Path, changelog: str, said: str
) -> None:
    with pytest.raises(version.ReleaseError, match=re.escape(said)):
        version.changes("1.2.0", tree(tmp_path, changelog))


def test_that_file_names_have_version_system_and_machine(version: ModuleType) -> None:
    for system, machine in (("Linux", "x86_64"), ("Linux", "aarch64"), ("Windows", "AMD64"), ("Darwin", "arm64")):
        names = version.file_names("1.2.0", system, machine)
        assert all("1.2.0" in name for name in names.values()) and len(set(names.values())) == len(names)
        assert {"wheel", "sdist"} < set(names)
    assert version.file_names("1.2.0", "Linux", "x86_64")["deb"] == "kirigami-studio_1.2.0_amd64.deb"
    assert version.file_names("1.2.0", "Windows", "AMD64")["installer"].endswith("windows-x86_64-setup.exe")


def test_that_scripts_for_other_systems_make_files_of_these_names(packaging: Path, version: ModuleType) -> None:
    script = (packaging / "windows" / "kirigami-studio.iss").read_text(encoding="utf-8")
    name = re.search(r"^OutputBaseFilename=(.+)$", script, re.MULTILINE)
    made = (name[1] if name else "").replace("{#Version}", "1.2.0").replace("{#Machine}", "x86_64")
    assert f"{made}.exe" == version.file_names("1.2.0", "Windows", "AMD64")["installer"]
    assert "version.py" in (packaging / "macos" / "dmg.sh").read_text(encoding="utf-8")


def test_that_a_tree_with_changes_is_not_released(
    packaging: Path, version: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(packaging))
    release = loaded("release", packaging / "release.py")
    root = tree(tmp_path, "## 1.2.0 - 2026-12-01\n\n- New.\n")
    monkeypatch.setattr(version, "ROOT", root)
    monkeypatch.setattr(release, "ROOT", root)
    monkeypatch.setattr(release, "version", lambda: version.version(root))
    monkeypatch.setattr(release, "changes", lambda wanted: version.changes(wanted, root))
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "-C", str(root)]
    for words in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "All"]):
        subprocess.run([*git, *words], check=True)
    release.check_tree()
    (root / "stray.txt").write_text("left over", encoding="utf-8")
    with pytest.raises(version.ReleaseError, match=r"stray\.txt"):
        release.check_tree()


def test_that_a_file_that_was_not_made_stops_a_release(
    packaging: Path, version: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(packaging))
    release = loaded("release", packaging / "release.py")
    (tmp_path / "a.whl").write_bytes(b"a")
    with pytest.raises(version.ReleaseError, match=r"b\.deb"):
        release.write_sums(tmp_path, ["a.whl", "b.deb"])
    release.write_sums(tmp_path, ["a.whl"])
    assert (tmp_path / "SHA256SUMS").read_text(encoding="ascii").startswith("ca978112ca1bbdcafac231b39a23dc4da786eff8")


def test_that_notes_of_a_release_are_what_the_changelog_says_of_it(
    packaging: Path, version: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(packaging))
    release = loaded("release", packaging / "release.py")
    for said, wanted in (("## UNRELEASED\n\n## 1.2.0 - 2026-12-01\n\n- New.\n", "- New."),
                         ("## UNRELEASED\n\n- Newer.\n\n## 1.1.0 - 2026-12-01\n\n- New.\n", "- Newer.")):  # fmt: skip
        folder = tmp_path / wanted.strip("- .")
        folder.mkdir()
        root = tree(folder, said)
        monkeypatch.setattr(release, "version", lambda root=root: version.version(root))
        monkeypatch.setattr(release, "changes", lambda wanted, root=root: version.changes(wanted, root))
        monkeypatch.setattr(release, "unreleased", lambda root=root: version.unreleased(root))
        notes = release.write_notes(tmp_path)
        assert notes.name == "kirigami-studio-1.2.0-notes.md"
        assert notes.read_text(encoding="utf-8") == f"# Kirigami Studio 1.2.0\n\n{wanted}\n"


def test_that_the_program_prints_its_own_completion_for_the_packages(
    bundle: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "kirigami-studio"
    program.write_text('#!/bin/sh\necho "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setattr(bundle, "manual", lambda: ".TH")
    assert bundle.shell_files(program) == {
        "bash-completion/completions/kirigami-studio": "completion bash\n",
        "zsh/site-functions/_kirigami-studio": "completion zsh\n",
        "man/man1/kirigami-studio.1": ".TH",
    }


def test_that_the_menu_entry_starts_the_command_of_the_wheel_with_a_project(packaging: Path, repository: Path) -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.optionxform = str  # type: ignore[assignment, method-assign]
    entry.read(packaging / "linux" / "kirigami-studio.desktop", encoding="utf-8")
    fields = entry["Desktop Entry"]
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert fields["Exec"].split() == [*project["scripts"], "%f"]
    assert fields["Comment"].rstrip(".") in project["description"]
    assert (repository / "resources" / "icons" / f"{fields['Icon']}.svg").is_file()
    kind = ElementTree.parse(packaging / "linux" / "kirigami-studio.xml").getroot().find(f"{MIME}mime-type")
    assert kind is not None and fields["MimeType"] == f"{kind.get('type')};"
    globs = [glob.get("pattern") for glob in kind.iter(f"{MIME}glob")]
    assert globs == [f"*{SUFFIX}"]
    icon = (kind.get("type") or "").replace("/", "-")
    assert (packaging / "linux" / f"{icon}.svg").is_file()


def test_that_software_centres_are_told_the_same(packaging: Path, bundle: ModuleType, repository: Path) -> None:
    about = ElementTree.fromstring(bundle.dated((packaging / "linux" / bundle.METAINFO).read_text(encoding="utf-8")))
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"{about.findtext('id')}.metainfo.xml" == bundle.METAINFO
    assert about.findtext("project_license") == project["license"]
    assert about.findtext("launchable") == "kirigami-studio.desktop"
    assert about.findtext("provides/binary") in project["scripts"]
    release = about.find("releases/release")
    assert release is not None and release.get("version") == __version__
    assert re.fullmatch(r"\d{4}-\d{2}-\d{2}", release.get("date") or "")


@pytest.mark.skipif(shutil.which("appstreamcli") is None, reason="appstreamcli is not installed")
def test_that_the_description_for_software_centres_is_valid(
    packaging: Path, bundle: ModuleType, tmp_path: Path
) -> None:
    text = bundle.dated((packaging / "linux" / bundle.METAINFO).read_text(encoding="utf-8"))
    (tmp_path / bundle.METAINFO).write_text(text, encoding="utf-8")
    command = ["appstreamcli", "validate", "--no-net", str(tmp_path / bundle.METAINFO)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_that_macos_and_windows_open_projects_with_the_program(packaging: Path, bundle: ModuleType) -> None:
    told = plistlib.loads(plistlib.dumps(bundle.information()))
    kind = told["UTExportedTypeDeclarations"][0]
    assert kind["UTTypeTagSpecification"]["public.filename-extension"] == [SUFFIX.lstrip(".")]
    assert told["CFBundleDocumentTypes"][0]["LSItemContentTypes"] == [kind["UTTypeIdentifier"]]
    plistlib.loads((packaging / "macos" / "entitlements.plist").read_bytes())
    script = (packaging / "windows" / "kirigami-studio.iss").read_text(encoding="utf-8")
    assert rf"Software\Classes\{SUFFIX}" in script and '""%1""' in script


@pytest.mark.parametrize("script", ["linux/install.sh", "macos/dmg.sh", "system_libraries.sh"])
def test_that_shell_scripts_can_be_read_by_sh(packaging: Path, script: str) -> None:
    subprocess.run(["sh", "-n", str(packaging / script)], check=True)


def test_that_the_archive_installs_and_removes_itself(packaging: Path, tmp_path: Path) -> None:
    unpacked, prefix = tmp_path / "unpacked", tmp_path / "prefix"
    (unpacked / "share" / "applications").mkdir(parents=True)
    shutil.copy(packaging / "linux" / "kirigami-studio.desktop", unpacked / "share" / "applications")
    shutil.copy(packaging / "linux" / "install.sh", unpacked)
    program = unpacked / "kirigami-studio"
    program.write_text("#!/bin/sh\necho started\n", encoding="utf-8")
    program.chmod(0o755)
    (prefix / "share" / "applications").mkdir(parents=True)
    other = prefix / "share" / "applications" / "other.desktop"
    other.write_text("[Desktop Entry]\n", encoding="utf-8")
    for _ in range(2):  # again, over an older one
        subprocess.run(["sh", str(unpacked / "install.sh"), str(prefix)], check=True, capture_output=True)
    command = prefix / "bin" / "kirigami-studio"
    assert subprocess.run([str(command)], capture_output=True, text=True, check=True).stdout == "started\n"
    entry = (prefix / "share" / "applications" / "kirigami-studio.desktop").read_text(encoding="utf-8")
    assert f'Exec="{command}" %f' in entry
    installed = prefix / "lib" / "kirigami-studio" / "install.sh"
    subprocess.run(["sh", str(installed), "--remove", str(prefix)], check=True, capture_output=True)
    left = [path for path in prefix.rglob("*") if not path.is_dir() and path.suffix != ".cache"]  # the desktop's own
    assert left == [other]


def test_that_resources_libraries_and_licences_stay_in_the_bundle(bundle: ModuleType) -> None:
    site = "/env/lib/python3.11/site-packages/"
    kept = (
        "kirigami_studio/resources/models/prior.safetensors",
        "kirigami_studio/resources/locale/de/LC_MESSAGES/kirigami_studio.mo",
        "PySide6/Qt/plugins/platforms/libqxcb.so",
        "PySide6/Qt/plugins/platforms/libqoffscreen.so",
        "PySide6/Qt/plugins/iconengines/libqsvgicon.so",
        "PySide6/Qt/lib/libQt6Widgets.so.6",
        "PySide6/Qt/translations/qtbase_de.qm",
        "torch/lib/libtorch_cpu.so",
        "skimage/measure/__init__.pyi",
        "reportlab/fonts/Vera.ttf",
    )
    out = (
        "PySide6/Qt/plugins/platforms/libqeglfs.so",
        "PySide6/Qt/lib/libQt6Quick.so.6",
        "PySide6/Qt/translations/qtbase_fr.qm",
        "torch/lib/libtorchbind_test.so",
        "torch/include/torch/extension.h",
        "skimage/data/coffee.png",
        "numpy/_core/tests/test_dtype.py",
    )
    assert [place for place in kept if bundle.left_out(place, site + place)] == []
    assert [place for place in out if not bundle.left_out(place, site + place)] == []
    if sys.platform.startswith("linux"):
        assert bundle.left_out("libGL.so.1", "/lib/x86_64-linux-gnu/libGL.so.1")
        assert not bundle.left_out("libxcb-cursor.so.0", "/lib/x86_64-linux-gnu/libxcb-cursor.so.0")


def test_that_every_package_that_is_shipped_has_its_licence_in_the_bundle(bundle: ModuleType) -> None:
    for name, package in packages().items():
        if name == "kirigami-studio" or CHOSEN.get(name, ("", ()))[1]:  # ours, and those whose texts are in resources
            continue
        folder = Path(str(package.distribution.locate_file(""))) / bundle.metadata_folder(package.distribution)
        files = [path for path in folder.rglob("*") if path.is_file() and bundle.is_licence(path.relative_to(folder))]
        assert files, name


def test_that_the_bundle_is_made_of_the_resources_and_of_all_modules_but_the_lab(packaging: Path) -> None:
    spec = (packaging / "kirigami-studio.spec").read_text(encoding="utf-8")
    assert 'collect_data_files("kirigami_studio", includes=["resources/**"])' in spec
    assert 'collect_submodules("kirigami_studio", filter=' in spec and '"kirigami_studio.lab"]' in spec
    assert "licence_files(" in spec


def test_that_pins_are_of_versions_that_the_project_allows(packaging: Path, repository: Path) -> None:
    wanted = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    names = {re.split(r"[<>=!~; ]", line)[0].lower().replace("_", "-") for line in wanted}
    lines = (packaging / "constraints-bundle.txt").read_text(encoding="utf-8").splitlines()
    pins = dict(line.partition(" ;")[0].split("==") for line in lines if "==" in line)
    assert names <= {name.lower().replace("_", "-") for name in pins}
    torch = next(line for line in wanted if line.startswith("torch=="))
    assert pins["torch"].partition("+")[0] == torch.removeprefix("torch==")


def test_that_a_frozen_program_refuses_to_train_in_one_sentence(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    assert main(["train", "prior", "--out", "nowhere"]) == 2
    assert "does not train" in capsys.readouterr().err
    assert main(["targets", "--json"]) == 0
    assert "heart" in json.loads(capsys.readouterr().out)["targets"]


def test_that_a_program_without_standard_streams_ends_as_it_should(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdout", None)
    monkeypatch.setattr(sys, "stderr", None)
    assert main(["targets"]) == 0
    assert main(["licences", "none-such"]) == 2
