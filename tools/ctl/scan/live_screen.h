// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace disparityd::tools {

/// Shows pictures of text on standard output: on a terminal each in the place of the one before, elsewhere one after
/// the other. One thread uses it.
class LiveScreen {
public:
    LiveScreen();

    bool in_place() const { return in_place_; }  ///< standard output is a terminal that can do so
    bool colour() const;                         ///< it shows colours, and NO_COLOR is not set
    bool utf8() const;                           ///< the locale says so

    /// The size of the terminal now; 80 x 24 where there is none.
    int columns() const;
    int rows() const;

    /// Lines must be printable, but for colours. Throws std::runtime_error when they cannot be written.
    void show(const std::vector<std::string>& lines);

private:
    bool in_place_;
    bool cleared_ = false;
};

}  // namespace disparityd::tools
