// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// How many pixels of poles and wires are found, by the width of what they lie on.
class ThinWidths {
public:
    static constexpr int widest = 6;

    struct Count {
        std::size_t pixels = 0;
        std::size_t found = 0;  ///< with a disparity that is at most 1 px off
    };

    /// Adds the pixels of an image where `thin` is not 0 and the truth is known. The width at a pixel is that of the
    /// shorter of two runs, along its row and along its column, of such pixels whose truths differ by less than 1 px
    /// from one to the next. Throws std::invalid_argument when the sizes differ.
    void add(const images::FloatMap& disparity, const images::FloatMap& truth, const std::vector<std::uint8_t>& thin);

    /// Of this width in px, 1 .. widest; 0 has those that are wider.
    const Count& of(int width) const { return counts_[static_cast<std::size_t>(width)]; }

private:
    std::array<Count, widest + 1> counts_{};
};

struct NamedThinWidths {
    std::string name;  ///< of the matcher
    ThinWidths widths;
};

/// A line for each width that occurs: pixels, and percent of them that each matcher finds.
void print_thin_widths(const std::vector<NamedThinWidths>& all, bool markdown, std::ostream& out);

/// A list of objects: name, width (px, 0: more than 6), pixels, found.
nlohmann::ordered_json thin_widths_json(const std::vector<NamedThinWidths>& all);

}  // namespace disparityd::eval
