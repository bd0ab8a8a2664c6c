"""Writes every scene for every engine below a folder: NAME.json, NAME.yaml, NAME.xml, NAME-1.xml (one point a loop)."""

import json
import pathlib

import formats
import reference


def emit(scenes, folder):
    """Writes what is not there yet or has changed; returns the names."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for scene in scenes:
        count = 1 if len(scene.bodies) > 1000 else 4
        with open(folder / f"{scene.name}.json", "w", encoding="utf-8") as file:
            json.dump(reference.as_json(scene, reference.states_of(scene, count)), file)
        (folder / f"{scene.name}.yaml").write_text(formats.ferrers_yaml(scene), encoding="utf-8")
        (folder / f"{scene.name}.xml").write_text(formats.mujoco_xml(scene), encoding="utf-8")
        (folder / f"{scene.name}-1.xml").write_text(formats.mujoco_xml(scene, points=1), encoding="utf-8")
    return [scene.name for scene in scenes]


if __name__ == "__main__":
    import sys

    import mechanisms

    print(*emit(mechanisms.all_scenes(), sys.argv[1]))
