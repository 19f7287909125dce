"""Holds report.json and residuals.csv of a result against their schemas.

python3 validate.py SCHEMAS RESULT
"""
import csv
import json
import pathlib
import sys

import jsonschema

schemas, result = (pathlib.Path(folder) for folder in sys.argv[1:])


def validator(name):
    schema = json.loads((schemas / name).read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def rows(file):
    """The rows of residuals.csv as objects."""
    with open(file, newline="") as lines:
        table = csv.reader(lines)
        names = next(table)
        for cells in table:
            row = dict(zip(names, cells, strict=True))
            for name in ("sample", "feature", "id"):
                if name in row:
                    row[name] = int(row[name]) if row[name] else None
            row["distance"] = float(row["distance"])
            for name in names:
                if name.startswith("residual_"):
                    row[name] = float(row[name]) if row[name] else None
            yield row


errors = []
report = json.loads((result / "report.json").read_text())
errors += [f"report.json: {e.json_path}: {e.message}" for e in validator("report.schema.json").iter_errors(report)]
of_row = validator("residuals.schema.json")
count = 0
for count, row in enumerate(rows(result / "residuals.csv"), 1):
    errors += [f"residuals.csv:{count + 1}: {e.message}" for e in of_row.iter_errors(row)]
if count == 0:
    errors.append("residuals.csv: no rows")
print("\n".join(errors), file=sys.stderr)
sys.exit(1 if errors else 0)
