// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "daemon/config/config.h"
#include "tests/temporary_folder.h"

namespace disparityd::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> notes_on_folder(const std::string& section, const std::string& path, bool enabled = true) {
    const std::string text = "[" + section + "]\nenabled = " + (enabled ? "true" : "false") + "\ndirectory = \"" + path;
    return daemon::parse_config(text + "\"\n", "my.toml").notes;
}

// The daemon runs without them, so --check and the log tell it, and nothing is refused.
TEST(FolderNotes, AFolderThatCannotBeWrittenToIsTold) {
    const TemporaryFolder folder;
    EXPECT_THAT(notes_on_folder("record", folder.path()), IsEmpty());
    EXPECT_THAT(notes_on_folder("record", folder.file("absent")),
                ElementsAre(AllOf(HasSubstr("my.toml:3:1: [record] directory"), HasSubstr(folder.file("absent")),
                                  HasSubstr("No such file"), HasSubstr("recordings are refused until"))));
    EXPECT_THAT(notes_on_folder("record", folder.write("file", "")), ElementsAre(HasSubstr("Not a directory")));
    EXPECT_THAT(notes_on_folder("self_calibration", folder.file("absent")),
                ElementsAre(AllOf(HasSubstr("[self_calibration] directory"), HasSubstr("no correction is kept"))));
}

TEST(FolderNotes, AFolderThatIsNotUsedIsNotLookedAt) {
    EXPECT_THAT(notes_on_folder("record", "/absent", false), IsEmpty());
    EXPECT_THAT(daemon::parse_config("", "my.toml").notes, IsEmpty());
}

}  // namespace
}  // namespace disparityd::test
