#!/usr/bin/env python3
"""Draws the pictures of docs/: `tools/draw_figures.py FERRERS`, the built command. Writes docs/img/*.svg.

The marks of bands.svg are computed by the command; tests/docs_test.cc checks that it still says the same.
"""

import json
import math
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INK, RED, BLUE, GREY = "#222", "#c0392b", "#1f5fa8", "#888"


def svg(width, height, body):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            'font-family="sans-serif" font-size="13">\n'
            f'<rect width="{width}" height="{height}" rx="6" fill="#fff"/>\n' + "\n".join(body) + "\n</svg>\n")


def text(x, y, words, anchor="middle", color=INK, size=13):
    return f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}" fill="{color}" font-size="{size}">{words}</text>'


def line(x1, y1, x2, y2, color=INK, width=1.5, dash=""):
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="M{x1:g} {y1:g}L{x2:g} {y2:g}" stroke="{color}" stroke-width="{width}" fill="none"{dashed}/>'


def arrow(x, y, dx, dy, color):
    length = math.hypot(dx, dy)
    ux, uy = dx / length, dy / length
    tip, base = (x + dx, y + dy), (x + dx - 10 * ux, y + dy - 10 * uy)
    head = f"M{tip[0]:g} {tip[1]:g}L{base[0] - 5 * uy:g} {base[1] + 5 * ux:g}L{base[0] + 5 * uy:g} {base[1] - 5 * ux:g}Z"
    return line(x, y, *base, color, 2.5) + f'<path d="{head}" fill="{color}"/>'


def turn(x, y, color):
    """An arc about a point, clockwise, with a head."""
    return (f'<path d="M{x - 15:g} {y:g}A15 15 0 1 1 {x:g} {y + 15:g}" stroke="{color}" stroke-width="2.5" fill="none"/>'
            f'<path d="M{x - 10:g} {y + 15:g}l10 -6v12Z" fill="{color}"/>')


def door():
    body = []
    lower, upper = 265, 85
    for left, title, note in [(60, "the load", "exact: the sum of both hinges"),
                              (310, "a self-stress: force_z", "any size, no load needed"),
                              (560, "another: force_x, moment_y", "any size, no load needed")]:
        body += [text(left + 75, 28, title, size=14), text(left + 75, 345, note, color=GREY, size=12),
                 line(left, 45, left, 315, GREY, 6),
                 f'<rect x="{left + 12}" y="55" width="120" height="250" fill="#f1e3cf" stroke="{INK}"/>']
        for y in (lower, upper):
            body.append(f'<rect x="{left - 3}" y="{y - 14}" width="18" height="28" rx="3" fill="#ccc" stroke="{INK}"/>')
    body += [f'<circle cx="132" cy="180" r="4" fill="{INK}"/>', arrow(132, 180, 0, 60, INK),
             text(140, 215, "m·g", "start"), text(102, 170, "b", color=GREY), line(66, 180, 128, 180, GREY, 1, "3 3"),
             line(38, upper, 38, lower, GREY, 1), text(28, 180, "h", color=GREY),
             text(90, upper + 5, "upper", "start", size=12), text(90, lower + 5, "lower", "start", size=12)]
    body += [arrow(340, upper - 18, 0, 50, RED), arrow(340, lower + 18, 0, -50, RED)]
    body += [arrow(640, upper, -55, 0, RED), arrow(585, lower, 55, 0, RED), turn(608, upper + 34, RED)]
    return svg(780, 365, body)


def bands(ferrers):
    left, right, top, bottom = 90, 620, 40, 400
    x = lambda error: left + (right - left) * (math.log10(error) + 16) / 16
    y = lambda value: bottom - (bottom - top) * (math.log10(value) + 16.5) / 17
    body = []
    for low, high, color, words in [(1e-5, 10**0.5, "#e3f1e3", "surely not zero"), (1e-10, 1e-5, "#fdf3d0", "in doubt"),
                                    (10**-16.5, 1e-10, "#e6ecf5", "surely zero")]:
        body += [f'<rect x="{left}" y="{y(high):g}" width="{right - left}" height="{y(low) - y(high):g}" fill="{color}"/>',
                 text(right + 10, (y(low) + y(high)) / 2 + 4, words, "start")]
    for k in range(0, 17, 5):
        body.append(text(left - 8, y(10.0**-k) + 4, f"1e-{k}" if k else "1", "end", size=12))
    for k in range(1, 16, 2):
        body.append(text(x(10.0**-k), bottom + 18, f"1e-{k}", size=12))
    body += [line(left, top, left, bottom), line(left, bottom, right, bottom), line(left, y(1e-5), right, y(1e-5), GREY, 1),
             line(left, y(1e-10), right, y(1e-10), GREY, 1), text((left + right) / 2, bottom + 40, "error in b, m"),
             text(left, top - 14, "singular values of the loop, over the largest one", "start")]
    exact = math.sin(math.radians(110)) / math.sin(math.radians(50))
    for k in range(1, 16):
        error = 10.0**-k
        done = subprocess.run([ferrers, "analyze", str(ROOT / "examples/bennett/model.yaml"), "--json", "-p",
                               f"b={exact + error:.17g} m"], capture_output=True, check=True)
        certainty = json.loads(done.stdout)["certainty"]
        for value in certainty["singular_values"]:
            share = value / certainty["singular_values"][0]
            color = BLUE if certainty["confident"] else RED
            body.append(f'<circle data-error="1e-{k}" data-value="{share:.4g}" cx="{x(error):.1f}" '
                        f'cy="{y(max(share, 10**-16.4)):.1f}" r="4" fill="{color}"/>')
    body += [f'<circle cx="{right + 18}" cy="{bottom - 2}" r="4" fill="{BLUE}"/>', text(right + 28, bottom + 2, "certain", "start"),
             f'<circle cx="{right + 18}" cy="{bottom + 18}" r="4" fill="{RED}"/>', text(right + 28, bottom + 22, "in doubt", "start")]
    return svg(760, 460, body)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = ROOT / "docs/img"
    folder.mkdir(exist_ok=True)
    (folder / "door.svg").write_text(door(), encoding="utf-8")
    (folder / "bands.svg").write_text(bands(sys.argv[1]), encoding="utf-8")


if __name__ == "__main__":
    main()
