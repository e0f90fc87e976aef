// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <opencv2/imgproc.hpp>

#include "capture/images/image_decoders.h"
#include "capture/images/image_header.h"

namespace disparityd::capture {
namespace {

/// What stands before the pixels.
struct PnmHead {
    char kind = '5';  ///< the digit of the magic number: 1 to 3 is text, 4 to 6 is bytes
    int width = 0, height = 0;
    std::uint64_t largest = 1;  ///< value of a pixel; of bitmaps 1
    std::size_t end = 0;        ///< where the last number ends

    bool bitmap() const { return kind == '1' || kind == '4'; }
    int channels() const { return kind == '3' || kind == '6' ? 3 : 1; }
    int value_bytes() const { return largest > 255 ? 2 : 1; }
    cv::Mat image() const {
        return cv::Mat(height, width, CV_MAKETYPE(value_bytes() == 2 ? CV_16U : CV_8U, channels()));
    }
};

PnmHead read_pnm_head(std::string_view file, const std::string& path) {
    constexpr std::size_t longest_head = 4096;
    constexpr std::uint64_t most_pixels = largest_image_side, most_value = 65535;
    PnmHead head{.kind = file[1]};
    std::array<std::uint64_t, 3> numbers{0, 0, head.bitmap() ? 1U : 0U};
    head.end = read_pnm_numbers(file.substr(0, longest_head), std::span(numbers).first(head.bitmap() ? 2 : 3));
    if (head.end == 0 || numbers[0] < 1 || numbers[1] < 1 || numbers[0] > most_pixels || numbers[1] > most_pixels ||
        numbers[2] < 1 || numbers[2] > most_value) {
        throw std::invalid_argument(path + ": is damaged: the header of the " + (head.bitmap() ? "PBM" : "PGM or PPM") +
                                    " says no size, or no largest value from 1 to 65535");
    }
    head.width = static_cast<int>(numbers[0]);
    head.height = static_cast<int>(numbers[1]);
    head.largest = numbers[2];
    return head;
}

/// Reads numbers one after the other; those of a bitmap are digits, which may stand together.
class PnmNumbers {
public:
    PnmNumbers(std::string_view text, bool digits) : text_(text), digits_(digits) {}

    /// Nothing: the next thing is no number, or the text ends.
    std::optional<std::uint64_t> next() {
        while (!ended() && (std::isspace(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '#')) {
            const bool comment = text_[at_] == '#';  // up to the end of its line
            at_ = comment ? std::min(text_.find('\n', at_), text_.size()) : at_ + 1;
        }
        if (ended() || !is_digit()) {
            return std::nullopt;
        }
        constexpr std::uint64_t enough = 1'000'000;  // no value is so large
        std::uint64_t value = 0;
        do {
            value = std::min(10 * value + static_cast<std::uint64_t>(text_[at_] - '0'), enough);
            ++at_;
        } while (!digits_ && at_ < text_.size() && is_digit());
        return value;
    }
    bool ended() const { return at_ == text_.size(); }

private:
    bool is_digit() const { return std::isdigit(static_cast<unsigned char>(text_[at_])) != 0; }

    std::string_view text_;
    bool digits_;
    std::size_t at_ = 0;
};

template <typename Value>
void read_pnm_text(PnmNumbers& numbers, const PnmHead& head, cv::Mat& image, const std::string& path) {
    for (int y = 0; y < image.rows; ++y) {
        auto* const row = image.ptr<Value>(y);
        for (int i = 0; i < image.cols * image.channels(); ++i) {
            const auto number = numbers.next();
            if (!number) {
                throw std::invalid_argument(path + (numbers.ended()
                                                        ? ": is damaged: the file was cut off, values are missing"
                                                        : ": is damaged: found something that is no number"));
            }
            const std::uint64_t value = std::min(*number, head.largest);
            const std::uint64_t scaled = sizeof(Value) == 1 ? value * 255 / head.largest : value;
            row[i] = static_cast<Value>(head.bitmap() ? 255 - scaled : scaled);  // 1 is black
        }
    }
}

void read_pnm_bits(const std::uint8_t* from, cv::Mat& image) {
    for (int y = 0; y < image.rows; ++y) {
        std::uint8_t* const row = image.ptr(y);
        for (int x = 0; x < image.cols; ++x) {
            row[x] = (from[x / 8] >> (7 - x % 8) & 1) != 0 ? 0 : 255;
        }
        from += (image.cols + 7) / 8;
    }
}

void read_pnm_bytes(const std::uint8_t* from, cv::Mat& image) {
    const int values = image.cols * image.channels();
    for (int y = 0; y < image.rows; ++y) {
        if (image.depth() == CV_8U) {
            std::copy_n(from, values, image.ptr(y));
            from += values;
            continue;
        }
        auto* const row = image.ptr<std::uint16_t>(y);
        for (int i = 0; i < values; ++i, from += 2) {
            row[i] = static_cast<std::uint16_t>(from[0] << 8 | from[1]);
        }
    }
}

}  // namespace

cv::Mat decode_pnm(std::span<const std::uint8_t> file, const std::string& path) {
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (text[1] == 'f' || text[1] == 'F') {
        throw std::invalid_argument(
            path + ": found floats (PFM), allowed are whole numbers of 8 or 16 bits: convert it to PNG");
    }
    const PnmHead head = read_pnm_head(text, path);
    cv::Mat image = head.image();
    if (head.kind < '4') {
        PnmNumbers numbers(text.substr(head.end), head.bitmap());
        if (head.value_bytes() == 1) {
            read_pnm_text<std::uint8_t>(numbers, head, image, path);
        } else {
            read_pnm_text<std::uint16_t>(numbers, head, image, path);
        }
    } else {
        const std::size_t row = head.bitmap() ? (static_cast<std::size_t>(head.width) + 7) / 8
                                              : static_cast<std::size_t>(head.width) * image.elemSize();
        const std::size_t least = head.end + 1 + row * static_cast<std::size_t>(head.height);
        if (file.size() < least) {
            refuse_cut_image(path, file.size(), least);
        }
        const std::uint8_t* const pixels = file.data() + head.end + 1;
        head.bitmap() ? read_pnm_bits(pixels, image) : read_pnm_bytes(pixels, image);
    }
    if (image.channels() == 3) {
        cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
    }
    return image;
}

}  // namespace disparityd::capture
