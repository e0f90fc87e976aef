// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace disparityd::tools {

constexpr const char* corrections_name = "corrections.csv";

/// What a run may replace in the folder that it fills.
enum class Replacing {
    nothing,
    unfinished,   ///< an earlier run that has left no manifest
    earlier_run,  ///< whatever an earlier run has left
};

/// What a folder holds before a run.
struct FolderContent {
    std::string other;   ///< the name of a file that is no range, where there is any
    std::string range;   ///< the name of a range of --split, where there is any
    bool begun = false;  ///< by this program
    bool known = false;  ///< with parameters that are known
    bool finished = false;
};

/// Looks into a folder, which need not be there.
FolderContent content_of(const std::filesystem::path& folder);

/// Throws std::invalid_argument with one line where the folder holds anything but what may be replaced, or a finished
/// run that is to stay.
void check_content(const std::string& folder, const FolderContent& found, Replacing replacing);

/// Removes what an earlier run has left in a folder, and nothing else: the files of the frames that its times.csv
/// names, and its lists. Throws std::runtime_error when the system refuses.
void remove_earlier_run(const std::string& folder);

/// Removes what a process that was killed has left half written, but for its manifest, which tells what it was begun
/// with. Throws std::runtime_error when the system refuses.
void remove_half_written(const std::string& folder);

}  // namespace disparityd::tools
