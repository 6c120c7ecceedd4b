"""What type checkers and readers are told about the package is what the package has."""

import ast
import inspect
import pathlib
import re
import typing

import pytest

import mosbench
from mosbench import _mosbench

STUBS = pathlib.Path(mosbench.__file__).with_name("_mosbench.pyi")


def public(names):
    return {name for name in names if not name.startswith("_")}


def members(node):
    """Names that a class of the stubs declares."""
    return {one.name if isinstance(one, ast.FunctionDef) else one.target.id for one in node.body}


def test_stubs_declare_what_the_module_has():
    stated = {}
    for node in ast.parse(STUBS.read_text()).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            stated[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            stated[node.target.id] = node
    assert public(stated) == public(vars(_mosbench))
    for name, node in stated.items():
        if isinstance(node, ast.ClassDef):
            assert public(members(node)) == public(vars(getattr(_mosbench, name))), name


def test_the_package_is_marked_as_typed_and_says_what_everything_is():
    assert STUBS.with_name("py.typed").exists()
    for name in mosbench.__all__:
        value = getattr(mosbench, name)
        if inspect.isclass(value) or inspect.isfunction(value):
            assert value.__doc__, name
            for member, one in vars(value).items():
                if inspect.isfunction(one) and not member.startswith("_"):
                    assert one.__doc__, f"{name}.{member}"


def described(doc):
    """Names that a text describes, as in "points: (N, 3), metres. pose, truth: (4, 4)"."""
    starts = re.findall(r"(?:^|\n\s*|\. |; )([a-z]\w*(?:, [a-z]\w*)*): ", doc or "")
    return {name for start in starts for name in start.split(", ")}


def test_help_describes_arguments_that_there_are():
    calls = {name: getattr(mosbench, name) for name in mosbench.__all__}
    for name, one in list(calls.items()):
        if inspect.isclass(one):
            calls.update({f"{name}.{member}": call for member, call in vars(one).items() if inspect.isfunction(call)})
    found = set()
    for name, call in calls.items():
        if not inspect.isfunction(call):
            continue
        taken = set(inspect.signature(call).parameters)
        told = described(call.__doc__)
        assert told <= taken | {"data", "reading"}, name
        found |= told
    assert len(found) > 30, found


def test_help_describes_arguments_that_cannot_be_guessed():
    """Arrays have shapes, lengths and shares units; what every function calls the same is told once, by `run`."""
    told_once = {"data", "dataset", "sequences", "reading", "protocol", "preset", "method", "threads", "overwrite"}
    for name in mosbench.__all__:
        call = getattr(mosbench, name)
        if not inspect.isfunction(call):
            continue
        for argument in inspect.signature(call).parameters.values():
            if argument.annotation in ("Any", "Iterable[Any]") and argument.name not in told_once:
                assert re.search(rf"\b{argument.name}\b", call.__doc__), f"{name}({argument.name})"


@pytest.mark.skipif(not hasattr(typing, "get_overloads"), reason="Python before 3.11 does not tell overloads")
def test_type_checkers_know_that_a_named_sequence_is_one():
    told = [call.__annotations__ for call in typing.get_overloads(mosbench.open)]
    assert {one["sequence"]: one["return"] for one in told} == {"str": "Sequence", "None": "Union[Dataset, Sequence]"}


def test_help_says_what_a_result_has(finished):
    for value in (finished, finished[0]):
        told = " ".join(type(value).__doc__.split())
        for name in public(vars(value)):
            assert f" {name}: " in told, name
        for name, one in vars(type(value)).items():
            assert not isinstance(one, property) or one.__doc__, name
