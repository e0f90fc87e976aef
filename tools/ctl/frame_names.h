// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

namespace disparityd::tools {

/// Names the files of each frame: the name of the input without its ending ("000012_10" of 000012_10.png), or the
/// frame's number in six digits where frames have no name. The same frames in the same order get the same names.
class FrameNames {
public:
    /// Returns the name for the next frame. `input` is the name of its file, without a folder; empty = it has none. A
    /// name whose files (NAME.png, NAME_colour.png) would be those of an earlier frame gets "-2", "-3" ... at its end.
    std::string next(std::string_view input);

private:
    std::uint64_t count_ = 0;
    std::set<std::string, std::less<>> taken_;
};

}  // namespace disparityd::tools
