# SPDX-License-Identifier: Apache-2.0
"""check_docs.py must find what it is there to find."""
import pathlib
import tempfile
import unittest

import check_docs

HOWTO = "# X\n\n## Files to open\n\n- `daemon/a.cpp`: why\n\n## How to test\n\nSo.\n"


class CheckDocs(unittest.TestCase):
    def found_in(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            for name, text in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_docs.mistakes(root)

    def test_accepts_what_is_true(self):
        self.assertEqual(self.found_in({
            "daemon/a.cpp": "// See docs/b.md.\n",
            "docs/b.md": "# One `two`: three, four\n\n## A [link](c.md)\n\n## Same\n\n## Same\n\n"
                         "[here](#one-two-three-four) [there](c.md#first) [twice](#same-1) [link](#a-link)\n"
                         "`[no](link)` https://a.b/docs/none.md bridges/NAME/main.cpp `daemon/` [out](https://a.b/#c)\n"
                         "```\n[no](link)\n# no heading\n```\n",
            "docs/c.md": "First\n\n# First\n\nSee daemon/a.cpp and `daemon/a.cpp`. ![](d.png) <img src=\"d.png\" width=\"1\">\n",
            "docs/d.png": "",
            "docs/howto/e.md": HOWTO + "\n## Files to add\n\n- `bridges/NAME/main.cpp`: why\n",
        }), [])

    def test_finds_links_that_lead_nowhere(self):
        for text in ("[a](none.md)", "[a](#none)", "[a](b.md#none)", "![a](none.png)", '<img src="none.png">',
                     "- [x [y]](none.md)", "[a](../../outside.md)", "```\n```\n[a](none.md)", "[a](c.txt#part)"):
            with self.subTest(text=text):
                self.assertEqual(len(self.found_in({"docs/a.md": text, "docs/b.md": "# Some\n", "docs/c.txt": "part"})), 1)

    def test_finds_links_out_of_what_is_installed(self):
        files = {"README.md": "[a](docs/b.md)", "CONTRIBUTING.md": "", "docs/design/b.md": "[c](../c.md) `CONTRIBUTING.md`",
                 "docs/c.md": "", "docs/b.md": ""}
        self.assertEqual(self.found_in(files), [])
        self.assertEqual(len(self.found_in(files | {"docs/b.md": "[x](../CONTRIBUTING.md)"})), 1)

    def test_finds_paths_of_no_file(self):
        for text in ("see capture/none.h", "`kernels/cpu/none-inl.h`", "(tools/none.py)", "    daemon/none.cpp\n",
                     "the folder `kernels/none/`"):
            with self.subTest(text=text):
                self.assertEqual(len(self.found_in({"README.md": text, "capture/a.h": ""})), 1)

    def test_finds_pages_that_code_names(self):
        self.assertEqual(len(self.found_in({"daemon/a.h": "// docs/none.md\n", "tools/b": "# docs/design/none.md\n"})), 2)

    def test_finds_howtos_without_a_true_list(self):
        for page in (HOWTO.replace("daemon/a.cpp", "daemon/none.cpp"),                # also a path of no file
                     HOWTO.replace("## Files to open", "## Files"), HOWTO.replace("- `daemon/a.cpp`: why", "- a.cpp"),
                     HOWTO.replace("## How to test", "## Tests"), HOWTO.replace("`: why", "`"),
                     HOWTO + "\n## Files to add\n\n- `daemon/b.cpp`: why\n"):
            with self.subTest(page=page):
                self.assertNotEqual(self.found_in({"daemon/a.cpp": "", "docs/howto/x.md": page}), [])


if __name__ == "__main__":
    unittest.main()
