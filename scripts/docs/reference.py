#!/usr/bin/env python3
"""reference.py MOSBENCH [--check]: writes docs/reference from what the program says of itself: its commands, settings,
protocols and formats. With --check writes nothing and fails where a page is not what it would write."""

import json
import pathlib
import re
import subprocess
import sys

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/reference"
HEAD = "# {}\n\nWritten by `scripts/docs/reference.py` from the program: change that, not this page.\n"


def cell(value):
    """Returns what a cell of a table shows; | would end it and < begin a tag."""
    if isinstance(value, bool):
        value = "yes" if value else "no"
    if isinstance(value, float):
        value = f"{value:.10g}"
    text = str("" if value is None else value).replace("|", "\\|").replace("<", "\\<")
    return re.sub(r"\S*@\S+", r"`\g<0>`", text)  # a command of doxygen outside code


def table(heads, rows):
    lines = [heads, ["---"] * len(heads), *[[cell(value) for value in row] for row in rows]]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def code(text):
    return f"```text\n{text.strip()}\n```\n"


def legal(setting):
    """Returns the legal values of a setting."""
    return ", ".join(setting["choices"]) if "choices" in setting else f"{cell(setting['lowest'])} to {cell(setting['highest'])}"


def settings_of(kinds):
    """Returns a section with a table of settings for each method or odometry."""
    heads = ["setting", "default", "unit", "legal", "meaning"]
    return "\n".join(
        f"### {kind['name']}\n{kind['summary']}. {kind['source']}\n\n" +
        (table(heads, [[f"`{one['name']}`", one.get("default", f"as {one.get('follows')}"), one.get("unit"), legal(one),
                        one["meaning"]] for one in kind["settings"]]) if kind["settings"] else "It has no settings.\n")
        for kind in kinds)


def values(settings):
    return ", ".join(f"{name}={cell(value)}" for name, value in settings.items())


def settings(listed):
    odometry = listed["odometry"]
    return "\n".join([
        HEAD.format("Settings"), "## Methods\n", settings_of(listed["methods"]), "## Odometry\n", settings_of(odometry["kinds"]),
        "### Presets of odometry", table(["preset", "odometry", "settings"], [
            [one["name"], one["odometry"], values(one["settings"])] for one in odometry["presets"]]),
        "## Presets", table(["preset", "data set", "method", "protocol", "settings", "from"], [
            [one["name"], one["dataset"], one["method"], one["protocol"], values(one["settings"]), one["source"]]
            for one in listed["presets"]]),
        "## Disturbances", table(["kind", "unit", "no change", "from", "to", "what", "source"], [
            [one["name"], one["unit"], one["none"], one["lowest"], one["highest"], one["definition"], one["source"]]
            for one in listed["perturbations"]])])


def protocols(listed):
    facts = {"truth": "truth", "predicted moving": "moving", "range": "range", "average": "average", "scans": "split",
             "0/0": "zero_by_zero", "source": "source"}
    return HEAD.format("Protocols") + "".join(
        f"\n## {one['name']}\n{one['rule']}\n\n" + table(["fact", "value"], [[name, one[key]] for name, key in facts.items()])
        for one in listed["protocols"])


def formats(listed):
    datasets = "\n".join(
        f"### {one['name']}\n{one['title']}\n\n" +
        table(["fact", "value"], [[name, one[name]] for name in ("content", "size", "published", "licence", "written")]) +
        "\n" + code("\n".join(one["folders"])) for one in listed["datasets"])
    return "\n".join([
        HEAD.format("Formats"), "## Predictions", table(["format", "ending", "one per scan", "what"], [
            [one["name"], one["extension"], one["per_scan"], one["description"]] for one in listed["formats"]]),
        "## Data sets\n", datasets,
        "## Scenes", table(["scene", "what"], [[one["name"], one["content"]] for one in listed["scenes"]])])


def commands(ask):
    names = [line.split("\t")[0] for line in ask("help", "--completion", "commands").splitlines()]
    return HEAD.format("Commands") + "\n" + code(ask("--help")) + "".join(
        f"\n## {name}\n{code(ask(name, '--help-all'))}" for name in names)


def pages(program):
    """Returns the text of each page by its name."""
    def ask(*words):
        return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout
    listed = json.loads(ask("list", "--json"))
    return {"commands.md": commands(ask), "settings.md": settings(listed), "protocols.md": protocols(listed),
            "formats.md": formats(listed)}


def stale(written, folder):
    """Returns the names of pages that are absent, different or no longer written."""
    there = {path.name: path.read_text() for path in folder.glob("*.md")}
    return sorted(name for name in written.keys() | there.keys() if written.get(name) != there.get(name))


def main(program, *rest):
    written = pages(program)
    if rest == ("--check",):
        names = stale(written, FOLDER)
        print("\n".join([*(f"docs/reference/{name} is stale: run scripts/docs/reference.py {program}" for name in names),
                         f"{len(written)} pages checked, {len(names)} stale"]))
        return 1 if names else 0
    FOLDER.mkdir(exist_ok=True)
    for name, text in written.items():
        (FOLDER / name).write_text(text)
    return 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--check"]):
        sys.exit("usage: reference.py MOSBENCH [--check]")
    sys.exit(main(*sys.argv[1:]))
