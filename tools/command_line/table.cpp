// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/table.h"

#include <algorithm>
#include <ostream>

#include "base/message_text.h"

namespace disparityd::tools {

void Table::add(std::vector<std::string> row) {
    for (std::string& cell : row) {
        cell = base::printable(cell, cell.size());
    }
    rows_.push_back(std::move(row));
}

void Table::print(std::ostream& to, const std::string& indent) const {
    std::vector<std::size_t> widths;
    for (const auto& row : rows_) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) {
            widths[i] = std::max(widths[i], row[i].size());
        }
    }
    for (const auto& row : rows_) {
        std::string line = indent;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string padding(widths[i] - row[i].size(), ' ');
            line += i == 0 ? row[i] + padding : "  " + padding + row[i];
        }
        line.erase(line.find_last_not_of(' ') + 1);
        to << line << '\n';
    }
}

void Table::print_markdown(std::ostream& to) const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        to << '|';
        for (const std::string& cell : rows_[i]) {
            to << ' ' << cell << " |";
        }
        to << '\n';
        if (i == 0) {
            to << '|';
            for (std::size_t column = 0; column < rows_[0].size(); ++column) {
                to << (column == 0 ? " --- |" : " ---: |");
            }
            to << '\n';
        }
    }
}

}  // namespace disparityd::tools
