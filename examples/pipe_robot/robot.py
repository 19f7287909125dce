"""A robot for kinecal: one joint that turns a camera, simulated.  See README.md."""
import base64, json, struct, sys, time, zlib

way = {"start": 0.0, "goal": 0.0, "began": 0.0, "time": 1.0}
leds = 0

def position():  # radians: linear in time from start to goal
    share = min((time.time() - way["began"]) / way["time"], 1.0)
    return way["start"] + (way["goal"] - way["start"]) * share

def move(target):
    goal = dict(zip(target["names"], target["positions"])).get("pan", way["goal"])
    if abs(goal) > 1.5:
        return {"error": "pan turns from -1.5 to 1.5 radians"}
    duration = 0.2 / target["velocity_factor"]
    way.update(start=position(), goal=goal, began=time.time(), time=duration)
    return {}

def joints(_):
    return {"stamp": time.time_ns(), "names": ["pan"], "positions": [position()]}

def view(_):  # a bright bar that moves with the joint; the first pixel shows the LEDs
    bar = int(32 + 20 * position())
    row = bytes([0] + [200 if abs(u - bar) < 3 else 10 for u in range(64)])
    pixels = zlib.compress(bytes([0, leds]) + row[2:] + row * 47)
    png = b"\x89PNG\r\n\x1a\n"
    for name, data in ((b"IHDR", struct.pack(">IIBxxxx", 64, 48, 8)), (b"IDAT", pixels), (b"IEND", b"")):
        png += struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    camera = {"width": 64, "height": 48, "k": [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]}
    return {"stamp": time.time_ns(), "frame": "camera_optical_frame", "camera": camera,
            "image": {"base64": base64.b64encode(png).decode()}}

def light(code):
    global leds
    leds = code
    return {"stamp": time.time_ns()}

for line in sys.stdin:
    (request, value), = json.loads(line).items()
    time.sleep(0.005)  # what is measured now is after what was measured before
    print(json.dumps({"move": move, "joints": joints, "view": view, "light": light}[request](value)), flush=True)
