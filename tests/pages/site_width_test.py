#!/usr/bin/env python3
"""Pages of the documentation site on a phone: 390 pixels wide, nothing of them
lies beyond that but what scrolls by itself.

    tests/pages/site_width_test.py SITE

Each page is laid out by Chromium. Status 77, skipped: there is no `chromium`.
"""

import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

WIDTH = 390

# Frames are laid out as windows of their size are; windows cannot be that narrow.
MEASURE = """<!DOCTYPE html><body><script>
const pages = %s, widths = {};
async function main() {
  for (const page of pages) {
    const frame = document.createElement("iframe");
    frame.style = "border: 0; width: %dpx; height: 800px";
    frame.src = page;
    await new Promise(done => { frame.onload = done; document.body.append(frame); });
    const inside = frame.contentDocument;
    widths[page] = [inside.documentElement.scrollWidth, inside.body.textContent.length];
    frame.remove();
  }
  document.body.textContent = JSON.stringify(widths) + " measured";
}
main();
</script></body>"""


def main():
    site = pathlib.Path(sys.argv[1]).resolve()
    browser = shutil.which("chromium")
    if browser is None:
        print("no chromium: the width of the pages is not tested")
        return 77
    pages = [str(path.relative_to(site)) for path in sorted(site.rglob("*.html"))]
    with tempfile.TemporaryDirectory() as profile:
        measure = site / "measure_width.html"
        measure.write_text(MEASURE % (json.dumps(pages), WIDTH))
        dumped = subprocess.run(
            [browser, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-extensions",
             "--allow-file-access-from-files", f"--user-data-dir={profile}",
             "--window-size=1000,1000", "--timeout=120000", "--virtual-time-budget=120000",
             "--dump-dom", measure.as_uri()],
            capture_output=True, text=True, timeout=300).stdout
        measure.unlink()
    found = re.search(r"<body>(.*) measured", dumped, re.DOTALL)
    if not found:
        print(f"not measured: {dumped[-500:]}")
        return 1
    widths = json.loads(html.unescape(found[1]))
    assert set(widths) == set(pages) and all(length > 0 for _, length in widths.values())
    wide = [f"{page}: {width} pixels" for page, (width, _) in widths.items() if width > WIDTH]
    print("\n".join(wide) or f"{len(pages)} pages, none wider than {WIDTH} pixels")
    return bool(wide)


if __name__ == "__main__":
    sys.exit(main())
