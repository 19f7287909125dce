#!/usr/bin/env python3
"""How often `kinecal verify` rejects a result that holds: real samples, drawn at random.

  verify_halves.py PROGRAM DATA [DRAWS]

Calibrates on some samples of a recording and verifies with others of it; nothing has moved, so the share
of "does not hold" is the rate of false alarms.  DATA is the folder of the real data sets.
SPDX-License-Identifier: Apache-2.0
"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile

SETS = [  # folder, URDF, configuration, recording, calibrated samples, new samples
    ("ur5_tracker", "ur5.urdf", "full.yaml", "grid.yaml", 60, 6),
    ("ur5_tracker", "ur5.urdf", "full.yaml", "grid.yaml", 100, 20),
    ("mukca_panda", "panda.urdf", "panda_6/stable.yaml", "panda_6/front.yaml", 31, 31),
    ("mukca_panda", "panda.urdf", "panda_6/stable.yaml", "panda_6/front.yaml", 36, 5),
    ("mukca_panda", "panda.urdf", "panda_6/stable.yaml", "panda_6/right.yaml", 38, 8),
    ("fetch/synth", "fetch_arm_head.urdf", "calibrate.yaml", "samples.yaml", 50, 6),
]


def documents(path):
    return [d for d in path.read_text().split("\n---\n") if d.strip() and d.strip() != "---"]


def rejections(program, folder, files, count, fresh, draws):
    """Probabilities that verify states, and the movers it names if it rejects."""
    urdf, config, recording = (folder / name for name in files)
    samples = documents(recording)
    found = []
    for draw in range(draws):
        order = random.Random(draw).sample(range(len(samples)), count + fresh)
        with tempfile.TemporaryDirectory() as name:
            work = pathlib.Path(name)
            for file, part in (("old.yaml", order[:count]), ("new.yaml", order[count:])):
                (work / file).write_text("".join(samples[i] + "\n---\n" for i in part))
            subprocess.run([program, "calibrate", "--urdf", urdf, "--config", config, "--samples",
                            work / "old.yaml", "--output", work / "result", "--threads", "1"],
                           capture_output=True, check=False)
            report = work / "v.json"
            subprocess.run([program, "verify", work / "result", work / "new.yaml", "--report", report],
                           capture_output=True, check=False)
            if report.exists():  # else the calibration itself was refused
                found.append(json.loads(report.read_text()))
    return found


def main():
    program, data = sys.argv[1], pathlib.Path(sys.argv[2])
    draws = int(sys.argv[3]) if len(sys.argv) > 3 else 100
    print("data, samples calibrated + new: draws, rejected at 1 %, at 5 %, bad captures named")
    for folder, *files, count, fresh in SETS:
        found = rejections(program, data / folder, files, count, fresh, draws)
        below = [sum(f["probability"] < level for f in found) for level in (0.01, 0.05)]
        named = sum(bool(f["bad_samples"]) for f in found)
        print(f"{folder}/{files[2]}, {count} + {fresh}: {len(found)}, {below[0]}, {below[1]}, {named}",
              flush=True)


if __name__ == "__main__":
    main()
