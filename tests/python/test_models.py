"""Public humanoids read without errors, and with few findings.

REALNOID_BIN names the built binary.
"""

import os
import re
import subprocess

import pytest

from models import public_models

# Every finding that a model may cause: a new one is either a fault of the reader or news worth a look.
EXPECTED = {
    # Meshes of the first two are in a package whose package.xml has another name than their URDFs use.
    "g1": {("note", "ignored-attribute"), ("warning", "does-not-collide")},
    "simple_humanoid": {("note", "ignored-element"), ("warning", "does-not-collide")},
    "jvrc1": {("note", "ignored-element"), ("note", "collides-as"), ("note", "links-overlap")},
}


def check(path):
    binary = os.environ.get("REALNOID_BIN", "target/release/realnoid")
    return subprocess.run([binary, "check", str(path)], capture_output=True, text=True, timeout=60)


def model(name):
    return public_models()[name]


@pytest.mark.parametrize("name", EXPECTED)
def test_public_model_reads_without_errors(name):
    result = check(model(name))
    assert result.returncode == 0, result.stdout + result.stderr
    findings = set(re.findall(r"^(error|warning|note)\[([a-z0-9-]+)\]", result.stdout, flags=re.M))
    assert findings == EXPECTED[name], result.stdout
    assert re.search(r": 0 errors, ", result.stdout.splitlines()[-1])


def test_a_broken_model_fails_with_its_line(tmp_path):
    text = model("g1").read_text()
    lines = text.splitlines()
    line = next(i for i, content in enumerate(lines, 1) if "<mass value=" in content)
    lines[line - 1] = re.sub(r'value="[^"]*"', 'value="nan"', lines[line - 1])
    broken = tmp_path / "broken.urdf"
    broken.write_text("\n".join(lines))
    result = check(broken)
    assert result.returncode == 1
    assert "error[not-finite]" in result.stdout
    assert f"broken.urdf:{line}:" in result.stdout


def test_a_missing_file_is_said_so(tmp_path):
    result = check(tmp_path / "nowhere.urdf")
    assert result.returncode == 1
    assert "nowhere.urdf" in result.stderr and "cannot read" in result.stderr
