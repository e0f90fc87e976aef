# SPDX-License-Identifier: Apache-2.0
"""The picture in docs/architecture.md shows the arrows that the house rules enforce, and nothing else.

Usage: architecture_diagram_test.py. With Graphviz the picture is also made anew and must have the same folders, arrows and texts;
places and sizes depend on fonts and are not compared.
"""
import pathlib
import shutil
import sys
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))
import architecture_diagram as diagram  # noqa: E402

ARROWS = diagram.check_house.ARROWS
SVG = "{http://www.w3.org/2000/svg}"


def contents(svg):
    """Folders, arrows and, for each folder, the texts of its box."""
    nodes, edges, texts = set(), set(), {}
    for group in ElementTree.fromstring(svg).iter(SVG + "g"):
        title = group.findtext(SVG + "title")
        if group.get("class") == "node":
            nodes.add(title)
            texts[title] = [text.text for text in group.iter(SVG + "text")]
        elif group.get("class") == "edge":
            edges.add(tuple(title.split("->")))
    return nodes, edges, texts


def contents_of_file():
    return contents(diagram.PICTURE.read_text(encoding="utf-8"))


class Picture(unittest.TestCase):
    hint = "run tools/docs/architecture_diagram.py and commit the picture"

    def test_has_the_folders_of_the_house_rules(self):
        nodes, _, _ = contents_of_file()
        self.assertEqual(nodes, set(ARROWS), self.hint)

    def test_says_what_the_house_rules_say(self):
        _, edges, _ = contents_of_file()
        self.assertEqual(edges, set(diagram.drawn_arrows(ARROWS)), self.hint)
        for folder, targets in ARROWS.items():
            self.assertEqual(diagram.reachable(edges, folder), set(targets), folder)

    def test_names_what_each_folder_is(self):
        _, _, texts = contents_of_file()
        for folder in ARROWS:
            wanted = [f"{folder}/"] + diagram.FOLDERS[folder][0].split("<br/>")
            self.assertEqual(texts[folder], wanted, self.hint)

    @unittest.skipUnless(shutil.which("dot"), "needs dot (package graphviz)")
    def test_is_what_the_script_makes(self):
        self.assertEqual(contents(diagram.svg_text(diagram.dot_text(ARROWS))), contents_of_file(), self.hint)

    def test_is_shown(self):
        page = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
        self.assertTrue("](pictures/architecture.svg)" in page, "docs/architecture.md does not show the picture")


class Script(unittest.TestCase):
    def test_leaves_out_what_other_arrows_imply(self):
        arrows = {"tools": {"capture", "kernels"}, "capture": {"kernels"}, "kernels": set()}
        self.assertEqual(diagram.drawn_arrows(arrows), [("capture", "kernels"), ("tools", "capture")])

    def test_refuses_a_picture_that_allows_more_than_the_table(self):
        with self.assertRaisesRegex(ValueError, "more than the table"):
            diagram.dot_text({"tools": {"capture"}, "capture": {"kernels"}, "kernels": set()})

    def test_refuses_a_folder_without_a_text(self):
        with self.assertRaisesRegex(ValueError, "lacks a line for: attic"):
            diagram.dot_text({"attic": set()})


if __name__ == "__main__":
    unittest.main()
