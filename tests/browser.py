"""A page in a real browser without a screen: what it holds after its program and one of the test's have run."""

import html
import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

# No sandbox, which root cannot have; no calls of the browser's own to the network, of which it makes many.
_FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
SIZES = {"laptop": (1366, 768), "phone": (390, 844)}
_ERRORS = """<script>
const errors = [];
addEventListener("error", (event) => errors.push(event.message));
for (const name of ["error", "warn"]) console[name] = (...words) => errors.push(words.join(" "));
</script>"""


def chromium() -> str:
    """Return the path of Chromium: FINGERPAD_CHROMIUM, or the installed one; skip the test where there is none."""
    found = os.environ.get("FINGERPAD_CHROMIUM") or shutil.which("chromium")
    if not found:
        pytest.skip("chromium is not installed")
    return found


def asked(page: str, program: str, folder: Path, *, width: int = 1366, height: int = 768, scripts: bool = True) -> Any:
    """Return what a program returns that runs in the loaded page, and check that the page raises no error.

    Args:
        page: HTML.
        program: body of a JavaScript function; what it returns must be JSON.
        folder: for the page and the browser's own files.
        width: of the frame that the page is in, in pixels; a window cannot be as narrow as a phone.
        height: likewise.
        scripts: whether the page may run JavaScript; the program then runs in the page, or else beside it.
    """
    tell = f"""
    let answer = null;
    try {{ answer = (function (document) {{ {program}
    }})(page); }} catch (error) {{ errors.push(String(error.stack)); }}
    const told = place.createElement("pre");
    told.id = "told";
    told.textContent = JSON.stringify({{ answer, errors }});
    place.body.append(told);"""
    after = ""
    if scripts:
        before, _, end = page.replace("<head>", f"<head>{_ERRORS}", 1).rpartition("</body>")
        page = f"{before}<script>{{ const page = document, place = parent.document; {tell} }}</script></body>{end}"
    else:
        first = 'const errors = [], place = document, page = document.querySelector("iframe").contentDocument;'
        after = f"<script>onload = () => {{ {first} {tell} }};</script>"
    kind = "" if scripts else 'sandbox="allow-same-origin" '
    size = f'width="{width}" height="{height}" style="border: 0"'
    frame = folder / "frame.html"
    inner = f'<iframe {kind}{size} srcdoc="{html.escape(page)}"></iframe>'
    frame.write_text(f'<!DOCTYPE html><meta charset="utf-8"><body>{inner}{after}', encoding="utf-8")
    flags = [*_FLAGS, f"--user-data-dir={folder / 'profile'}", "--window-size=1500,1000", "--dump-dom"]
    environment = os.environ | {"HOME": str(folder)}
    done = subprocess.run(
        [chromium(), *flags, frame.as_uri()], capture_output=True, text=True, env=environment, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    said = re.search(r'<pre id="told">(.*?)</pre>', done.stdout, re.DOTALL)
    assert said, "the page was not loaded"
    found = json.loads(html.unescape(said[1]))
    assert found["errors"] == [], found["errors"]
    return found["answer"]
