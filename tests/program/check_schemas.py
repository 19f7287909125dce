"""Holds the schemas of input files against the readers of the program, both ways.

python3 check_schemas.py PROGRAM SOURCE

1. What the examples have, the schemas accept, also as a step of several.
2. What the schemas name, the program reads: a file with every key has no unknown one.
3. A misspelt key, a map in place of a value and a step within a step are refused by both.
"""
import copy
import functools
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema
import yaml

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
robot = source / "examples/mobile_manipulator/mobile_manipulator.urdf"
work = pathlib.Path(tempfile.mkdtemp())
errors = []


def schema(name):
    content = json.loads((source / f"include/kinecal/config/schema/{name}.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(content)
    return content


def run(kind, content):
    """What the program says of a file."""
    file = work / f"{kind}.yaml"
    file.write_text(yaml.safe_dump(content, sort_keys=False))
    (work / "table.csv").write_text("a,b,c\n1,2,3\n")
    calls = {
        "calibrate": ["check", "--urdf", robot, "--config", file],
        "capture": ["detect", file, "--images", work, "--poses", work / "table.csv", "--frame", "f",
                    "-o", work / "s.yaml", "--force"],
        "columns": ["convert", work / "table.csv", work / "s.yaml", "--columns", file, "--force"],
        "scene": ["simulate", robot, "--scene", file, "-o", work / "sim", "--force"],
    }
    done = subprocess.run([program, *map(str, calls[kind])], capture_output=True, text=True)
    if done.returncode < 0:
        errors.append(f"{kind}: the program crashed")
    return done


def unknown_keys(kind, content):
    """The keys that the program does not know in a file; "qqqqqq" also if it misses a name or type."""
    done = run(kind, content)
    unknown = set(re.findall(r"unknown key '([^']*)'", done.stderr + done.stdout))
    missing = re.findall(r"\b(name|type) is missing", done.stderr)
    return unknown | {"qqqqqq"} if missing else unknown


def example(of, whole):
    """A value that a part of a schema accepts, with every key that it names."""
    if "$ref" in of:
        return example(functools.reduce(dict.get, of["$ref"].split("/")[1:], whole), whole)
    if "anyOf" in of:
        return example(of["anyOf"][0], whole)
    if "enum" in of:
        return of["enum"][0]
    kind = of.get("type", "integer")
    kind = kind[0] if isinstance(kind, list) else kind
    if kind == "object":
        value = {key: example(inner, whole) for key, inner in of.get("properties", {}).items()}
        more = of.get("additionalProperties")
        if isinstance(more, dict) and not value:
            value["some"] = example(more, whole)
        return value
    if kind == "array":
        return [example(of.get("items", {}), whole)] * of.get("minItems", 1)
    return {"boolean": True, "string": of.get("examples", ["some"])[0]}.get(kind, 1)


def types_in(of):
    """The values of a key `type`, which decides what other keys there are."""
    return of["properties"]["type"].get("examples", [None])


def check_read(kind, contents):
    """Each key is read in at least one of the contents that have it."""
    left = set.intersection(*(unknown_keys(kind, content) for content in contents))
    errors.extend(f"{kind}.schema.json: '{key}' is not read" for key in left)


def check_every_key():
    calibrate = schema("calibrate")
    keys = calibrate["anyOf"][0]["properties"]
    del keys["cal_steps"]
    block = keys["error_blocks"]["items"]
    whole = example(calibrate, calibrate)
    whole["models"] = [{**whole["models"][0], "type": "camera2d"}]
    check_read("calibrate", [{**whole, "error_blocks": [{**example(block, calibrate), "type": kind}]}
                             for kind in types_in(block)])

    capture = schema("capture")
    finder = capture["anyOf"][0]["properties"]["features"]["additionalProperties"]
    check_read("capture", [{**example(capture, capture), "features": {
        "found": {**example(finder, capture), "type": kind, "leds": []}}} for kind in types_in(finder)])

    columns = example(schema("columns"), schema("columns"))
    observation = columns["observations"][0]
    check_read("columns", [{**columns, "observations": [
        {key: value for key, value in observation.items() if key != other}]}
        for other in ("points", "pixels")])  # one has a unit
    check_read("scene", [example(schema("scene"), schema("scene"))])


def keys_of(content, way=()):
    """The way to each key of a file whose name a user does not choose."""
    if isinstance(content, dict):
        chosen = way and way[-1] in ("columns", "conditions", "initial_values", "bounds", "features", "values")
        for key, value in content.items():
            if not chosen:
                yield (*way, key)
            yield from keys_of(value, (*way, key))
    elif isinstance(content, list) and content:
        yield from keys_of(content[0], (*way, 0))


def changed(content, way, change):
    """A copy in which `change` was applied to the map of a key."""
    content = copy.deepcopy(content)
    inner = content
    for key in way[:-1]:
        inner = inner[key]
    change(inner, way[-1])
    return content


def misspell(inner, key):
    inner["qqqqqq"] = inner.pop(key)


def replace_by_map(inner, key):
    inner[key] = {"qqqqqq": {"qqqqqq": 1}}


def check_examples():
    for kind, names in (("calibrate", ["mobile_manipulator/calibrate.yaml", "robots/fetch/calibrate.yaml",
                                       "robots/panda/calibrate.yaml"]),
                        ("columns", ["csv/columns.yaml"])):
        validator = jsonschema.Draft202012Validator(schema(kind))
        for name in names:
            content = yaml.safe_load((source / "examples" / name).read_text())
            errors.extend(f"{name}: {e.json_path}: {e.message}" for e in validator.iter_errors(content))
            accepted = run(kind, content).returncode == 0  # not the robot of another example
            for way in keys_of(content):
                wrong = changed(content, way, misspell)
                if validator.is_valid(wrong):
                    errors.append(f"{name}: the schema accepts {way} misspelt")
                if "qqqqqq" not in unknown_keys(kind, wrong):
                    errors.append(f"{name}: the program accepts {way} misspelt")
                wrong = changed(content, way, replace_by_map)
                if accepted and validator.is_valid(wrong) != (run(kind, wrong).returncode == 0):
                    errors.append(f"{name}: schema and program disagree about {way} as a map")


def check_steps():
    validator = jsonschema.Draft202012Validator(schema("calibrate"))
    for file in sorted((source / "examples").rglob("calibrate.yaml")):
        content = yaml.safe_load(file.read_text())
        steps = {"cal_steps": {"first": content}}
        within = {"cal_steps": {"first": steps}}
        for right in (content, steps):
            errors.extend(f"{file}: {e.json_path}: {e.message}" for e in validator.iter_errors(right))
        if validator.is_valid(within) or "cal_steps" not in unknown_keys("calibrate", within):
            errors.append(f"{file}: a step within a step is accepted")
        for way in keys_of(content):
            for change in (misspell, replace_by_map):
                whole = changed(content, way, change)
                if validator.is_valid(whole) != validator.is_valid({"cal_steps": {"first": whole}}):
                    errors.append(f"{file}: {way} is accepted in one of step and file only")


check_every_key()
check_examples()
check_steps()
print("\n".join(errors))
sys.exit(1 if errors else 0)
