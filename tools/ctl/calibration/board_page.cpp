// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/calibration/board_page.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "base/number_text.h"

namespace disparityd::tools {
namespace {

using base::fixed;

/// Printers leave such an edge of the paper white, and detectors want a white rim around the board; mm.
constexpr double edge_mm = 10;

/// Height of what stands below the board, with its distance; mm.
constexpr double foot_mm = 17;

constexpr double bar_mm = 100;
constexpr double points_per_mm = 72 / 25.4;

/// Fills rectangles of one path, so that no renderer leaves hairlines between those that touch. In mm, y down.
class BlackAreas {
public:
    void add(double x, double y, double width, double height) {
        path_ += fixed(x, 4) + ' ' + fixed(y, 4) + ' ' + fixed(width, 4) + ' ' + fixed(height, 4) + " re\n";
    }
    std::string filled() const { return path_ + "f\n"; }

private:
    std::string path_;
};

/// Whether a cell of a marker is black; its rim has the columns and rows 0 and side + 1.
bool is_black(const calibration::MarkerFamily& family, std::size_t number, int column, int row) {
    const bool rim = column == 0 || row == 0 || column > family.side || row > family.side;
    const int bit = family.side * family.side - 1 - ((row - 1) * family.side + column - 1);
    return rim || (family.codes[number] >> static_cast<unsigned>(bit) & 1U) == 0;
}

/// Draws a marker into the square at this place.
void draw_marker(BlackAreas& areas, const calibration::Board& board, std::size_t number, double left, double top) {
    const calibration::MarkerFamily& family = *board.markers->family;
    const double gap = board.square_mm * (1 - board.markers->part) / 2;
    const int cells = family.side + 2;
    const double cell = board.square_mm * board.markers->part / cells;
    for (int row = 0; row < cells; ++row) {
        for (int from = 0; from < cells; ++from) {
            int to = from;
            while (to < cells && is_black(family, number, to, row)) {
                ++to;
            }
            if (to > from) {
                areas.add(left + gap + from * cell, top + gap + row * cell, (to - from) * cell, cell);
                from = to;
            }
        }
    }
}

void draw_board(BlackAreas& areas, const calibration::Board& board, double left, double top) {
    std::size_t marker = 0;
    for (int row = 0; row <= board.rows; ++row) {
        for (int column = 0; column <= board.columns; ++column) {
            const double x = left + column * board.square_mm;
            const double y = top + row * board.square_mm;
            if ((column + row) % 2 == 0) {
                areas.add(x, y, board.square_mm, board.square_mm);
            } else if (board.markers) {
                draw_marker(areas, board, marker++, x, y);
            }
        }
    }
}

/// Draws a thin line with a tick at each 10 mm; from the outer side of the first to that of the last it is as long as
/// it says.
void draw_bar(BlackAreas& areas, double left, double top) {
    constexpr double line = 0.3;
    constexpr double tick_mm = 10;
    areas.add(left, top + 1.5 - line, bar_mm, line);
    for (double at = 0; at <= bar_mm; at += tick_mm) {
        areas.add(left + std::clamp(at - line / 2, 0.0, bar_mm - line), top, line, 1.5);
    }
}

std::string text_at(double x, double y, const Paper& paper, const std::string& text) {
    std::string escaped;
    for (const char letter : text) {
        escaped += letter == '(' || letter == ')' || letter == '\\' ? std::string{'\\', letter} : std::string{letter};
    }
    return "BT /F1 8 Tf " + fixed(x * points_per_mm, 3) + ' ' + fixed((paper.height - y) * points_per_mm, 3) + " Td (" +
           escaped + ") Tj ET\n";
}

/// Puts objects into a file with the table of their places. The first one is the catalogue.
std::string pdf_of(const std::vector<std::string>& objects) {
    // Bytes above 127 in the second line tell programs that copy files that this is no text.
    std::string file = "%PDF-1.6\n%\xe2\xe3\xcf\xd3\n";
    std::string table = "0000000000 65535 f \n";
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const std::string place = std::to_string(file.size());
        table += std::string(10 - place.size(), '0') + place + " 00000 n \n";
        file += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
    }
    const std::string place = std::to_string(file.size());
    const std::string count = std::to_string(objects.size() + 1);
    return file + "xref\n0 " + count + '\n' + table + "trailer\n<< /Size " + count + " /Root 1 0 R >>\nstartxref\n" +
           place + "\n%%EOF\n";
}

std::string millimetres(double width, double height) {
    return fixed(width, 1) + " x " + fixed(height, 1) + " mm";
}

}  // namespace

Paper paper_of_name(const std::string& name) {
    if (name == "a4") {
        return {297, 210};
    }
    if (name == "letter") {
        return {279.4, 215.9};
    }
    throw std::invalid_argument("--paper: found '" + name + "', allowed: a4 or letter");
}

std::string board_page(const calibration::Board& board, const Paper& paper, const std::vector<std::string>& lines) {
    const double width = (board.columns + 1) * board.square_mm;
    const double height = (board.rows + 1) * board.square_mm;
    const double most_width = paper.width - 2 * edge_mm;
    const double most_height = paper.height - edge_mm - foot_mm - 5;
    if (width > most_width || height > most_height) {
        const double most = std::min(most_width / (board.columns + 1), most_height / (board.rows + 1));
        throw std::invalid_argument("--square: the board has " + millimetres(width, height) +
                                    ", the paper has room for " + millimetres(most_width, most_height) +
                                    ": allowed is up to " + fixed(most - 0.05, 1) + ", or fewer --columns and --rows");
    }
    BlackAreas areas;
    const double top = edge_mm + (most_height - height) / 2;
    draw_board(areas, board, (paper.width - width) / 2, top);
    const double foot = paper.height - foot_mm;
    draw_bar(areas, edge_mm + 5, foot);
    const std::string scale = fixed(points_per_mm, 8);
    std::string content = "q " + scale + " 0 0 -" + scale + " 0 " + fixed(paper.height * points_per_mm, 4) +
                          " cm\n0 g\n" + areas.filled() + "Q\n0 g\n";
    content += text_at(edge_mm + 5 + bar_mm + 3, foot + 2, paper, fixed(bar_mm, 0) + " mm");
    double y = foot + 6;
    for (const std::string& line : lines) {
        content += text_at(edge_mm + 5, y, paper, line);
        y += 3.5;
    }
    const std::string box = fixed(paper.width * points_per_mm, 4) + ' ' + fixed(paper.height * points_per_mm, 4);
    return pdf_of({"<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
                   "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                   "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + box +
                       "] /Contents 4 0 R /Resources << /Font << /F1 5 0 R >> >> >>",
                   "<< /Length " + std::to_string(content.size()) + " >>\nstream\n" + content + "endstream",
                   "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"});
}

}  // namespace disparityd::tools
