# SPDX-License-Identifier: Apache-2.0
"""check_house.py must find what it is there to find."""
import pathlib
import tempfile
import unittest

import check_house

SPDX_LINE = "// SPDX-License-Identifier: Apache-2.0\n"


class CheckHouse(unittest.TestCase):
    def found_in(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_house.violations(root)

    def test_accepts_good_files(self):
        self.assertEqual(self.found_in({
            "kernels/a.h": SPDX_LINE + "#include <vector>\n",
            "pipeline/b.cpp": SPDX_LINE + '#include "kernels/a.h"\n#include "capture/frame_source.h"\n',
            "docs/c.md": "no licence line needed\n",
            "tests/fuzz/corpus/target/input": "bytes\n",
        }), [])

    def test_finds_missing_licence_line(self):
        self.assertEqual(len(self.found_in({"daemon/main.cpp": "int main() {}\n"})), 1)

    def test_finds_long_file(self):
        self.assertEqual(len(self.found_in({"daemon/long.cpp": SPDX_LINE + "\n" * check_house.MAX_LINES})), 1)

    def test_finds_includes_against_the_arrows(self):
        for name, header in [("kernels/a.cpp", "pipeline/pipeline.h"), ("kernels/cuda/a.cu", "pipeline/pipeline.h"), ("kernels/a.cpp", "opencv2/core.hpp"),
                             ("proto/a.cpp", "kernels/image.h"), ("clients/cpp/a.cpp", "kernels/image.h"),
                             ("pipeline/a.cpp", "daemon/config/config.h"), ("pipeline/a.cpp", "capture/recording/recorder.h"),
                             ("base/a.cpp", "kernels/image.h"), ("calibration/a.cpp", "capture/frame_source.h"),
                             ("tools/ctl/a.cpp", "daemon/config/config.h"), ("calibration/a.cpp", "pipeline/pipeline.h"),
                             ("capture/a.cpp", "pipeline/pipeline.h"), ("obstacles/a.cpp", "proto/shared_memory.h"), ("capture/a.cpp", "kernels/reference/sgm.h")]:
            with self.subTest(name=name, header=header):
                self.assertEqual(len(self.found_in({name: SPDX_LINE + f'#include "{header}"\n'})), 1)

    def test_finds_kinds_of_sources_where_they_are_not_known(self):
        for name, header in [("capture/frame_source.cpp", "capture/scene/scene_render.h"),
                             ("capture/usb/a.cpp", "capture/camera/video_system.h"),
                             ("capture/recording/a.cpp", "capture/images/image_files.h")]:
            with self.subTest(name=name, header=header):
                self.assertEqual(len(self.found_in({name: SPDX_LINE + f'#include "{header}"\n'})), 1)
        for name, header in [("capture/source_table.cpp", "capture/scene/scene_render.h"),
                             ("capture/camera/a.cpp", "capture/usb/sysfs.h"),
                             ("capture/scene/a.cpp", "capture/scene/b.h")]:
            with self.subTest(name=name, header=header):
                self.assertEqual(self.found_in({name: SPDX_LINE + f'#include "{header}"\n'}), [])

    def test_finds_types_of_one_name(self):
        def space(name, text):
            return SPDX_LINE + f"namespace {name} {{\n{text}}}  // namespace {name}\n"

        for kind in ("struct Point {", "class Point final {", "struct Point : Base {", "enum class Point : int {"):
            one = {"calibration/a.h": space("disparityd", f"{kind}\n}};\n")}
            for text, count in ((kind, 1), ("struct Point;", 0), ("struct Points {", 0), ("namespace {\n" + kind, 0)):
                with self.subTest(kind=kind, text=text):
                    other = space("disparityd", text + "\n};\n" + "}  // namespace\n" * text.startswith("namespace"))
                    self.assertEqual(len(self.found_in({**one, "calibration/b.cpp": other})), count)
            self.assertEqual(self.found_in({**one, "calibration/b.h": space("disparityd::scan", kind + "\n};\n")}), [])

    def test_finds_names_that_say_nothing(self):
        self.assertEqual(len(self.found_in({"daemon/utils.h": SPDX_LINE, "tools/common/a.h": SPDX_LINE})), 2)

    def test_finds_folders_with_too_many_files(self):
        many = {f"proto/f{i}.h": SPDX_LINE for i in range(check_house.MAX_FILES + 1)}
        self.assertEqual(len(self.found_in(many)), 1)
        self.assertEqual(self.found_in(many | {"proto/part/a.h": SPDX_LINE}), [])


if __name__ == "__main__":
    unittest.main()
