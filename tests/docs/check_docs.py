# SPDX-License-Identifier: Apache-2.0
"""What documents say of files must be true: links, anchors, paths, and the lists of files in docs/howto.

Usage: check_docs.py [ROOT]. Prints each mistake as FILE:LINE: text; exit status 1 if there is one.
"""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "house"))
import check_house  # noqa: E402

LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)")
HTML_LINK = re.compile(r'<(?:img|a)\s[^>]*?(?:src|href)="([^"]+)"')
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$")
CODE = re.compile(r"(`+)(?:(?!\1).)+\1")
ELSEWHERE = re.compile(r"^[a-z][a-z0-9+.-]*:")
# A file by its path from the root. NAME in it (bridges/NAME/main.cpp) stands for any name.
TOP = "|".join(sorted(check_house.FOLDERS | {"docs", "systemd", "cmake", "debian"}))
ENDINGS = "h|hpp|c|cpp|cu|py|proto|md|toml|txt|in|conf|rules|service|png|svg"
PATH = re.compile(rf"(?<![\w./*-])((?:{TOP})/[\w./-]*?\.(?:{ENDINGS}))(?![\w/-])(?!\.\w)")
FOLDER = re.compile(rf"`((?:{TOP})/(?:[\w./-]*/)?)`")
PLACEHOLDER = "NAME"
DOCUMENT = re.compile(r"\bdocs/[\w./-]*?\.md\b")
# "- `path`: why" in a section "Files to open" or "Files to add".
ENTRY = re.compile(r"^- `([^`]+)`: \S")
# Tests of checks, which name files that are not there.
EXAMPLES = ("tests/docs/", "tests/house/")
SECTION_OF_FILES = re.compile(r"^## Files to (open|add)\b")


def without_code(text):
    """The lines with code blanked out, so that only what is rendered as text is left."""
    lines, fence = [], None
    for line in text.splitlines():
        mark = re.match(r"^\s*(```+|~~~+)", line)
        if fence:
            if mark and mark.group(1).startswith(fence):
                fence = None
            lines.append("")
        elif mark:
            fence = mark.group(1)
            lines.append("")
        elif line.startswith("    ") and (not lines or not lines[-1].strip() or lines[-1] == "\t"):
            lines.append("\t")
        else:
            lines.append(line)
    return lines


def anchors(text):
    """The anchors that a page's headings get where it is shown on the web."""
    found, used = set(), {}
    for line in without_code(text):
        heading = HEADING.match(line)
        if not heading:
            continue
        title = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1))
        slug = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        used[slug] = used.get(slug, -1) + 1
        found.add(slug if used[slug] == 0 else f"{slug}-{used[slug]}")
    return found


def check_links(root, name, text, anchors_of):
    found = []
    for number, line in enumerate(without_code(text), 1):
        shown = CODE.sub(lambda code: "`" * len(code.group(0)), line)
        for target in LINK.findall(shown) + HTML_LINK.findall(shown):
            if ELSEWHERE.match(target):
                continue
            path, _, anchor = target.partition("#")
            file = (root / name).parent / path if path else root / name
            if not file.exists() or root not in file.resolve().parents:
                found.append(f"{name}:{number}: the link {target} leads nowhere")
            elif name.startswith("docs/") and root / "docs" not in file.resolve().parents:
                found.append(f"{name}:{number}: the link {target} leads out of docs/, which is installed without the source: name the "
                             f"file instead, as `{file.resolve().relative_to(root)}`")
            elif anchor and anchor not in anchors_of(file):
                found.append(f"{name}:{number}: the link {target} names no heading of {file.name}")
    return found


def check_paths(root, name, text):
    """Paths of the project's files and, between backquotes, folders, wherever a page names them."""
    return [f"{name}:{number}: there is no {path}" for number, line in enumerate(text.splitlines(), 1)
            for path in PATH.findall(line) + FOLDER.findall(line)
            if PLACEHOLDER not in path and not (root / path).exists()]


def check_documents(root, name, text):
    """Pages that comments and messages name."""
    return [f"{name}:{number}: there is no {path}" for number, line in enumerate(text.splitlines(), 1)
            for path in DOCUMENT.findall(line) if not (root / path).exists()]


def listed_files(text):
    """What a page of docs/howto lists, as (line number, kind of list, path or None where the line has another form)."""
    kind, found = None, []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("#"):
            section = SECTION_OF_FILES.match(line)
            kind = section.group(1) if section else None
        elif kind and line.startswith("-"):
            entry = ENTRY.match(line)
            found.append((number, kind, entry.group(1) if entry else None))
    return found


def check_howto(root, name, text):
    found = []
    entries = listed_files(text)
    if not any(kind == "open" for _, kind, _ in entries):
        found.append(f"{name}:1: no section 'Files to open' with a list of files")
    if not re.search(r"^## How to test\b", text, re.MULTILINE):
        found.append(f"{name}:1: no section 'How to test'")
    for number, kind, path in entries:
        if path is None:
            found.append(f"{name}:{number}: a file of the list is written as: - `path`: why")
        elif kind == "open" and not (root / path).is_file():
            found.append(f"{name}:{number}: there is no file {path}")
        elif kind == "add" and PLACEHOLDER not in path:
            found.append(f"{name}:{number}: {path} is to be added, so its name stands for any: write NAME")
    return found


def mistakes(root):
    found, pages = [], {}

    def anchors_of(file):
        if file not in pages:
            pages[file] = anchors(file.read_text(encoding="utf-8")) if file.suffix == ".md" else set()
        return pages[file]

    for name in check_house.project_files(root):
        if name.startswith(check_house.INPUTS) or name.startswith(EXAMPLES):
            continue
        try:
            text = (root / name).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        if not name.endswith(".md"):
            found += check_documents(root, name, text)
            continue
        found += check_links(root, name, text, anchors_of)
        found += check_paths(root, name, text)
        if name.startswith("docs/howto/") and not name.endswith("/README.md"):
            found += check_howto(root, name, text)
    return found


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = mistakes(root)
    print("\n".join(found) if found else "documents and files agree")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
