"""The gallery of the site: reports as the programs write them, made anew with it."""

import pathlib
import shutil
import subprocess

# Name, title, what there is to see, and the commands, which run in the project's folder.
# {out} is a folder for the results; the report of the last command is shown.
REPORTS = [
    ("three_storey", "A frame of three storeys",
     "Wrong stiffnesses, the damping and a hardening spring, from accelerations. A second record tests the model.",
     [["pinode_update", "--case=data/three_storey/three_storey.toml", "--output_dir={out}/fit"]]),
    ("impact", "A force that nobody measured",
     "The history of a load on a floor, found from the motion of the floors.",
     [["pinode_update", "--case=data/three_storey_force/impact.toml", "--output_dir={out}/fit"]]),
    ("modes", "Modes of wind records",
     "Frequencies, damping ratios and shapes with their intervals, without a model.",
     [["pinode_modes", "--case=data/three_storey_ambient/three_storey_ambient.toml",
       "--output_dir={out}/modes"]]),
    ("damage", "Damage of a steel frame",
     "The verdict on a later record against a baseline, and the structure in three dimensions.",
     [["pinode_update", "--case=data/frame/healthy_1.toml", "--output_dir={out}/fit"],
      ["pinode_damage", "--baseline={out}/fit", "--case=data/frame/column_20.toml",
       "--output_dir={out}/damage"]]),
]
# Folder of the last command where it is not "fit".
SHOWN = {"modes": "modes", "damage": "damage"}


def gallery(root, build, static, chosen):
    """What follows the introduction on the gallery's page. The reports of `chosen` (None:
    all) go to `static`."""
    text = ""
    for name, title, seen, commands in REPORTS:
        if chosen is not None and name not in chosen:
            continue
        out = static.parent / "reports" / name
        out.mkdir(parents=True)
        for command in commands:
            program, *options = [part.format(out=out) for part in command]
            # Status 1: the verdict is that something is wrong, which a report may say.
            done = subprocess.run([build / "apps" / program, *options, "--progress=false"],
                                  capture_output=True, text=True, check=False, cwd=root)
            if done.returncode not in (0, 1):
                raise RuntimeError(f"{program}: {done.stderr}")
        target = static / "reports" / f"{name}.html"
        target.parent.mkdir(exist_ok=True)
        shutil.copyfile(out / SHOWN.get(name, "fit") / "report.html", target)
        printed = "\n".join(" ".join(command).replace("{out}/", "")
                            for command in commands)
        text += (f"\n## {title}\n\n{seen}\n\n```none\n{printed}\n```\n\n"
                 f"<p><a href=\"../../_static/reports/{name}.html\">The report</a></p>\n\n"
                 f"<iframe class=\"report\" loading=\"lazy\" title=\"{title}\" "
                 f"src=\"../../_static/reports/{name}.html\"></iframe>\n")
    return text
