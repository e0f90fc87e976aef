// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "base/number_text.h"

namespace disparityd::tools {

/// Text in columns: the first column left-aligned, the others right-aligned. A cell is one line: control characters in
/// it become "?".
class Table {
public:
    explicit Table(std::vector<std::string> head) : rows_{std::move(head)} {}
    void add(std::vector<std::string> row);
    void print(std::ostream& to, const std::string& indent = {}) const;
    /// The same as a table in Markdown.
    void print_markdown(std::ostream& to) const;

private:
    std::vector<std::vector<std::string>> rows_;
};

using base::fixed;

}  // namespace disparityd::tools
