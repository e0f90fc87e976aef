// SPDX-License-Identifier: Apache-2.0
#include "capture/jpeg_decoder.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <new>
#include <vector>

#include <jpeglib.h>
// jpeglib.h comes first.
#include <jerror.h>

#include "capture/yuyv_rows.h"

namespace disparityd::capture {
namespace {

/// Rows of luma of the largest unit that libjpeg decodes at once.
constexpr std::size_t most_rows = std::size_t{MAX_SAMP_FACTOR} * DCTSIZE;

/// Cameras fill the data up to a multiple of four bytes. More before the end of the picture are data that the decoder
/// has lost its way in.
constexpr int most_padding = 3;

/// A JPEG's component: rows that libjpeg decodes into, and how many pixels one of its values stands for.
struct Component {
    std::vector<std::uint8_t> values;
    std::array<JSAMPROW, most_rows> rows{};
    int columns = 1;
    int lines = 1;
};

/// Returns chroma for every second pixel. `half` is memory for it.
const std::uint8_t* halved(const std::uint8_t* row, int columns, int pairs, std::vector<std::uint8_t>& half) {
    if (columns == 2) {
        return row;
    }
    for (int i = 0; i < pairs; ++i) {
        const int mean = (row[2 * i] + row[2 * i + 1] + 1) / 2;
        half[static_cast<std::size_t>(i)] = columns == 1 ? static_cast<std::uint8_t>(mean) : row[i / (columns / 2)];
    }
    return half.data();
}

}  // namespace

/// libjpeg reports errors by a function that must not return: a long jump to run(), which has no object that would have
/// to be destroyed.
struct JpegDecoder::State {
    jpeg_decompress_struct decompressor{};
    jpeg_error_mgr errors{};
    std::jmp_buf failed{};
    std::array<char, JMSG_LENGTH_MAX> reason{};
    EyeLayout layout;
    std::array<Component, 3> components;
    std::vector<std::uint8_t> half_u;
    std::vector<std::uint8_t> half_v;

    explicit State(const EyeLayout& eyes);
    ~State() { jpeg_destroy_decompress(&decompressor); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    bool run(std::span<const std::uint8_t> jpeg, std::uint8_t* to);
    [[noreturn]] void refuse(const char* why);
    void check_header();
    void check_components();
    void decode_rows(std::uint8_t* to);
    void write_row(int y, std::size_t row, std::uint8_t* to);

    static void fail(j_common_ptr common);
    static void warn(j_common_ptr common, int level);
    static void say_nothing(j_common_ptr /*common*/) {}
};

JpegDecoder::State::State(const EyeLayout& eyes) : layout(eyes) {
    const auto width = (static_cast<std::size_t>(layout.frame_width()) + most_rows - 1) / most_rows * most_rows;
    for (Component& component : components) {
        component.values.resize(width * most_rows, 128);
        for (std::size_t row = 0; row < most_rows; ++row) {
            component.rows[row] = component.values.data() + row * width;
        }
    }
    half_u.resize(width / 2);
    half_v.resize(width / 2);
    decompressor.err = jpeg_std_error(&errors);
    decompressor.client_data = this;
    errors.error_exit = fail;
    errors.emit_message = warn;
    errors.output_message = say_nothing;
    // NOLINTNEXTLINE(cert-err52-cpp): libjpeg knows no other way
    if (setjmp(failed) != 0) {
        throw std::bad_alloc();
    }
    jpeg_create_decompress(&decompressor);
}

void JpegDecoder::State::fail(j_common_ptr common) {
    State& state = *static_cast<State*>(common->client_data);
    common->err->format_message(common, state.reason.data());
    // NOLINTNEXTLINE(cert-err52-cpp)
    std::longjmp(state.failed, 1);
}

void JpegDecoder::State::warn(j_common_ptr common, int level) {
    const jpeg_error_mgr& error = *common->err;
    const bool padding = error.msg_code == JWRN_EXTRANEOUS_DATA && error.msg_parm.i[1] == JPEG_EOI &&
                         error.msg_parm.i[0] <= most_padding;
    if (level < 0 && !padding) {
        fail(common);
    }
}

void JpegDecoder::State::refuse(const char* why) {
    std::snprintf(reason.data(), reason.size(), "%s", why);
    // NOLINTNEXTLINE(cert-err52-cpp)
    std::longjmp(failed, 1);
}

void JpegDecoder::State::check_header() {
    const auto width = static_cast<JDIMENSION>(layout.frame_width());
    const auto height = static_cast<JDIMENSION>(layout.frame_height());
    if (decompressor.image_width != width || decompressor.image_height != height) {
        std::array<char, JMSG_LENGTH_MAX> text{};
        std::snprintf(text.data(), text.size(), "the JPEG has %ux%u pixels, expected %ux%u", decompressor.image_width,
                      decompressor.image_height, width, height);
        refuse(text.data());
    }
    if (decompressor.jpeg_color_space != JCS_GRAYSCALE && decompressor.jpeg_color_space != JCS_YCbCr) {
        refuse("the JPEG has neither grey nor YCbCr");
    }
    // Each scan goes over the whole picture: a small file with thousands would take minutes.
    if (jpeg_has_multiple_scans(&decompressor) != FALSE) {
        refuse("the JPEG has several scans (progressive); cameras send one");
    }
}

void JpegDecoder::State::check_components() {
    if (decompressor.num_components == 1) {
        for (Component& chroma : {std::ref(components[1]), std::ref(components[2])}) {
            std::fill(chroma.values.begin(), chroma.values.end(), std::uint8_t{128});
        }
    }
    for (int i = 0; i < decompressor.num_components; ++i) {
        const jpeg_component_info& info = decompressor.comp_info[i];
        Component& component = components[static_cast<std::size_t>(i)];
        component.columns = decompressor.max_h_samp_factor / info.h_samp_factor;
        component.lines = decompressor.max_v_samp_factor / info.v_samp_factor;
        const bool whole = component.columns * info.h_samp_factor == decompressor.max_h_samp_factor &&
                           component.lines * info.v_samp_factor == decompressor.max_v_samp_factor;
        const bool luma = i == 0;
        if (!whole || component.columns == 3 || (luma && (component.columns != 1 || component.lines != 1))) {
            refuse("the JPEG samples luma and chroma in a way that no camera does");
        }
    }
}

void JpegDecoder::State::decode_rows(std::uint8_t* to) {
    std::array<JSAMPARRAY, 3> planes{components[0].rows.data(), components[1].rows.data(), components[2].rows.data()};
    const int unit = decompressor.max_v_samp_factor * DCTSIZE;
    for (int top = 0; top < layout.frame_height(); top += unit) {
        jpeg_read_raw_data(&decompressor, planes.data(), static_cast<JDIMENSION>(unit));
        for (int row = 0; row < unit && top + row < layout.frame_height(); ++row) {
            write_row(top + row, static_cast<std::size_t>(row), to);
        }
    }
}

/// Writes row `y` of the frame, which is `row` of the unit that was decoded last, to where its eyes belong.
void JpegDecoder::State::write_row(int y, std::size_t row, std::uint8_t* to) {
    const std::uint8_t* luma = components[0].rows[row];
    const Component& blue = components[1];
    const Component& red = components[2];
    const int pairs = layout.frame_width() / 2;
    const std::uint8_t* u = halved(blue.rows[row / static_cast<std::size_t>(blue.lines)], blue.columns, pairs, half_u);
    const std::uint8_t* v = halved(red.rows[row / static_cast<std::size_t>(red.lines)], red.columns, pairs, half_v);
    const std::ptrdiff_t eye_bytes = std::ptrdiff_t{2} * layout.eye_width;
    const bool lower = layout.top_bottom && y >= layout.eye_height;
    std::uint8_t* line = to + (lower ? y - layout.eye_height : y) * 2 * eye_bytes;
    if (layout.as_lent()) {
        pack_yuyv(luma, u, v, pairs, line);
    } else if (layout.top_bottom) {
        pack_yuyv(luma, u, v, pairs, line + (lower != layout.right_first ? eye_bytes : 0));
    } else {
        pack_yuyv(luma, u, v, pairs / 2, line + eye_bytes);
        pack_yuyv(luma + layout.eye_width, u + pairs / 2, v + pairs / 2, pairs / 2, line);
    }
}

bool JpegDecoder::State::run(std::span<const std::uint8_t> jpeg, std::uint8_t* to) {
    // NOLINTNEXTLINE(cert-err52-cpp): libjpeg knows no other way
    if (setjmp(failed) != 0) {
        return false;
    }
    jpeg_mem_src(&decompressor, jpeg.data(), static_cast<unsigned long>(jpeg.size()));
    jpeg_read_header(&decompressor, TRUE);
    check_header();
    decompressor.out_color_space = decompressor.jpeg_color_space;
    decompressor.raw_data_out = TRUE;
    decompressor.dct_method = JDCT_ISLOW;
    decompressor.do_fancy_upsampling = FALSE;
    jpeg_start_decompress(&decompressor);
    check_components();
    decode_rows(to);
    jpeg_finish_decompress(&decompressor);
    return true;
}

JpegDecoder::JpegDecoder(const EyeLayout& layout) : state_(std::make_unique<State>(layout)) {}
JpegDecoder::~JpegDecoder() = default;

const char* JpegDecoder::decode(std::span<const std::uint8_t> jpeg, std::uint8_t* to) {
    if (state_->run(jpeg, to)) {
        return nullptr;
    }
    jpeg_abort_decompress(&state_->decompressor);
    return state_->reason.data();
}

}  // namespace disparityd::capture
