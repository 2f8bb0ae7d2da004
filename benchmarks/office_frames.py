"""Frames and scans a second of the simulated office, one core, everything on.

python benchmarks/office_frames.py
"""

from __future__ import annotations

from time import perf_counter

import cv2

from placecue_office.simulator import Office

WANTED = 60.0


def main() -> None:
    cv2.setNumThreads(1)
    print(f"320x240 frames and 361-beam scans, one core (wanted: {WANTED:.0f} frames/s)")
    for illumination in ("cloudy", "night", "sunny"):
        office = Office(illumination=illumination, speed=0.4)
        observations = iter(office)
        _ = next(observations).image  # compiles, and makes textures and light
        started, count = perf_counter(), 0
        for observation in observations:
            _ = observation.image
            count += 1
            if count == 400:
                break
        rate = count / (perf_counter() - started)
        print(f"{illumination:<7} {rate:6.0f} frames/s   {rate / WANTED:4.1f} times the aim")


main()
