"""What no answer may say and no command may leave behind."""

import json
import re
from pathlib import Path

import folders
from program import fault_of

FRACTIONS = {"iou", "precision", "recall", "f1", "baseline_iou", "new_iou", "first_iou", "second_iou"}
COUNTS = {"tp", "fp", "fn", "tn", "ignored", "unknown_ids", "points", "labelled_scans", "undefined_scans", "paired_scans"}
NOT_A_NUMBER = re.compile(r"(?<![\w./-])[+-]?(?:nan|inf)(?![\w./-])")
# The program says a name from an input between these, and a scan may be called nan.
NAME_BEFORE, NAME_AFTER = re.compile(r"(^|[:;,(] )(scan|sequence) $", re.MULTILINE), re.compile(r"^(:| is only)")
# The program repeats a place or a name from the command line there: at the start of a row, or after one of these.
GIVEN_BEFORE = re.compile(r"(?:^|\b(?:accepted|as|in|wrote|scans of|video|data set|method|first:|second:) )$", re.MULTILINE)
WORD_BEFORE, WORD_AFTER = re.compile(r"[A-Za-z-]+ $"), re.compile(r"^ [A-Za-z]+")
NEGATIVE_IOU = re.compile(r"^\S.* {2,}-\d+\.\d", re.MULTILINE)
# Their tables have no column that may be negative.
WITHOUT_NEGATIVES = {"run", "score"}


def _no_json(constant):
    raise ValueError(f"{constant} is no JSON")


def _wrong_number(value):
    """A sentence about a fraction or a count in JSON that cannot be; None when there is none."""
    if isinstance(value, list):
        return next(filter(None, map(_wrong_number, value)), None)
    if not isinstance(value, dict):
        return None
    for key, each in value.items():
        if isinstance(each, (dict, list)):
            if sentence := _wrong_number(each):
                return sentence
        elif key in FRACTIONS and each is not None and not 0 <= each <= 1:
            return f"{key} is {each}"
        elif key in COUNTS and each is not None and (each < 0 or each != int(each)):
            return f"{key} is {each}"
    return None


def wrong_json(text):
    if "\nUsage: mosbench " in text:
        return None  # --help beside --json
    try:
        value = json.loads(text, parse_constant=_no_json)
    except (ValueError, RecursionError) as error:
        return f"is no JSON: {error}"
    return _wrong_number(value)


def _stands_in_a_name(match, texts):
    """Whether an input's text says the same with a word before or after it: "range inf m" as a section of a table."""
    before, after = WORD_BEFORE.search(match.string[:match.start()]), WORD_AFTER.search(match.string[match.end():])
    if NAME_BEFORE.search(match.string[:match.start()]) and NAME_AFTER.search(match.string[match.end():]):
        return True
    names = [word for word in (before and before.group() + match.group(), after and match.group() + after.group()) if word]
    return any(re.search(rf"(?<![\w+-]){re.escape(name)}", text) for name in names for text in texts)


def _was_given(match, words):
    """Whether the command line gave it as a name, or as a part of a path, that the answer repeats as such."""
    parts = {part for word in words for part in re.split("[/=,:]", word)}
    return match.group() in parts and GIVEN_BEFORE.search(match.string[:match.start()]) is not None


def _texts_of(case):
    """The texts that a case gives to the program."""
    files = (file for file in Path(case).rglob("*") if file.suffix in (".csv", ".json", ".txt") and file.is_file())
    return [file.read_text(errors="replace") for file in files]


def _writes_json_to_a_file(words):
    """--json of profile names a file, whatever its ending."""
    return words[0] == "profile" and "--json" in words[:-1] and words[words.index("--json") + 1] != "-"


def _wrong_answer(ended, case):
    if _writes_json_to_a_file(ended.words):
        return None
    if "--json" in ended.words:
        return wrong_json(ended.out)
    # What a benchmark's own program prints may be nan.
    if "benchmark's rounding" not in ended.out:
        for match in NOT_A_NUMBER.finditer(ended.out):
            if not (_was_given(match, ended.words) or _stands_in_a_name(match, _texts_of(case))):
                return f"the answer says {match.group()}"
    if ended.words[0] in WITHOUT_NEGATIVES and (match := NEGATIVE_IOU.search(ended.out)):
        return f"negative number in a table: {match.group()}"
    return None


def faults_of(ended, case, before):
    """[(column, sentence)] of all that is wrong after a command; `before` are the leftovers that were there."""
    if fault := fault_of(ended):
        return [fault]
    faults = []
    if ended.code == 0 and (sentence := _wrong_answer(ended, case)):
        faults.append(("numbers", sentence))
    if ended.code == 0:
        for file in Path(case).glob("out/**/result.json"):
            if file.is_file() and (sentence := wrong_json(file.read_text(errors="replace"))):
                faults.append(("numbers", f"{file.relative_to(case)}: {sentence}"))
    if left := set(folders.leftovers(case)) - set(before):
        faults.append(("damaged", f"left behind: {', '.join(sorted(left)[:3])}"))
    return faults
