"""Holds the schemas of input files against the readers of the program, both ways.

python3 check_schemas.py PROGRAM SOURCE

1. What the examples have, the schemas accept.
2. What the schemas name, the program reads: a file with every key has no unknown one.
3. A misspelt key is refused by both.
"""
import copy
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


def unknown_keys(kind, content):
    """The keys that the program does not know in a file; "qqqqqq" also if it misses a name or type."""
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
    unknown = set(re.findall(r"unknown key '([^']*)'", done.stderr + done.stdout))
    missing = re.findall(r"\b(name|type) is missing", done.stderr)
    return unknown | {"qqqqqq"} if missing else unknown


def example(of):
    """A value that a schema accepts, with every key that it names."""
    if "anyOf" in of:
        return example(of["anyOf"][0])
    if "enum" in of:
        return of["enum"][0]
    kind = of.get("type", "integer")
    kind = kind[0] if isinstance(kind, list) else kind
    if kind == "object":
        value = {key: example(inner) for key, inner in of.get("properties", {}).items()}
        more = of.get("additionalProperties")
        if isinstance(more, dict) and not value:
            value["some"] = example(more)
        return value
    if kind == "array":
        return [example(of.get("items", {}))] * of.get("minItems", 1)
    return {"boolean": True, "string": of.get("examples", ["some"])[0]}.get(kind, 1)


def types_in(of):
    """The values of a key `type`, which decides what other keys there are."""
    return of["properties"]["type"].get("examples", [None])


def check_every_key():
    calibrate = schema("calibrate")["anyOf"][0]
    block = calibrate["properties"]["error_blocks"]["items"]
    whole = example(calibrate)
    del whole["cal_steps"]
    whole["models"] = [{**whole["models"][0], "type": "camera2d"}]
    left = None
    for kind in types_in(block):
        whole["error_blocks"] = [{**example(block), "type": kind}]
        found = unknown_keys("calibrate", whole)
        left = found if left is None else left & found
    errors.extend(f"calibrate.schema.json: '{key}' is not read" for key in left)

    capture = schema("capture")["anyOf"][0]
    finder = capture["properties"]["features"]["additionalProperties"]
    left = None
    for kind in types_in(finder):
        whole = example(capture)
        whole["features"] = {"found": {**example(finder), "type": kind, "leds": []}}
        found = unknown_keys("capture", whole)
        left = found if left is None else left & found
    errors.extend(f"capture.schema.json: '{key}' is not read" for key in left)

    columns = example(schema("columns"))
    left = None
    for kind in ("points", "pixels"):  # one has a unit
        whole = copy.deepcopy(columns)
        whole["observations"][0].pop("pixels" if kind == "points" else "points")
        found = unknown_keys("columns", whole)
        left = found if left is None else left & found
    errors.extend(f"columns.schema.json: '{key}' is not read" for key in left)
    errors.extend(f"scene.schema.json: '{key}' is not read"
                  for key in unknown_keys("scene", example(schema("scene"))))


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


def misspelt(content, way):
    content = copy.deepcopy(content)
    inner = content
    for key in way[:-1]:
        inner = inner[key]
    inner["qqqqqq"] = inner.pop(way[-1])
    return content


def check_examples():
    for kind, names in (("calibrate", ["mobile_manipulator/calibrate.yaml", "robots/fetch/calibrate.yaml",
                                       "robots/panda/calibrate.yaml"]),
                        ("columns", ["csv/columns.yaml"])):
        validator = jsonschema.Draft202012Validator(schema(kind))
        for name in names:
            content = yaml.safe_load((source / "examples" / name).read_text())
            errors.extend(f"{name}: {e.json_path}: {e.message}" for e in validator.iter_errors(content))
            for way in keys_of(content):
                wrong = misspelt(content, way)
                if validator.is_valid(wrong):
                    errors.append(f"{name}: the schema accepts {way} misspelt")
                if "qqqqqq" not in unknown_keys(kind, wrong):
                    errors.append(f"{name}: the program accepts {way} misspelt")


check_every_key()
check_examples()
print("\n".join(errors))
sys.exit(1 if errors else 0)
