// SPDX-License-Identifier: Apache-2.0
#include "formats/cdr_writer.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace disparityd::formats {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");

constexpr std::array<char, 4> header{0, 1, 0, 0};  // plain CDR, little endian, no options

}  // namespace

CdrWriter::CdrWriter(std::size_t expected) {
    bytes_.reserve(header.size() + expected);
    append(header.data(), header.size());
}

void CdrWriter::align(std::size_t size) {
    const std::size_t over = (bytes_.size() - header.size()) % size;
    bytes_.resize(bytes_.size() + (over == 0 ? 0 : size - over));
}

void CdrWriter::append(const void* data, std::size_t size) {
    const std::size_t before = bytes_.size();
    bytes_.resize(before + size);
    if (size > 0) {  // an empty sequence may have no address
        std::memcpy(&bytes_[before], data, size);
    }
}

template <typename Number>
CdrWriter& CdrWriter::number(Number value) {
    align(sizeof value);
    append(&value, sizeof value);
    return *this;
}

CdrWriter& CdrWriter::u8(std::uint8_t value) {
    return number(value);
}

CdrWriter& CdrWriter::boolean(bool value) {
    return u8(value ? 1 : 0);
}

CdrWriter& CdrWriter::i32(std::int32_t value) {
    return number(value);
}

CdrWriter& CdrWriter::u32(std::uint32_t value) {
    return number(value);
}

CdrWriter& CdrWriter::f32(float value) {
    return number(value);
}

CdrWriter& CdrWriter::f64(double value) {
    return number(value);
}

CdrWriter& CdrWriter::length(std::size_t elements) {
    if (elements > std::numeric_limits<std::uint32_t>::max()) {
        throw std::length_error("a sequence of " + std::to_string(elements) + " elements does not fit in CDR");
    }
    return u32(static_cast<std::uint32_t>(elements));
}

CdrWriter& CdrWriter::text(std::string_view value) {
    length(value.size() + 1);
    append(value.data(), value.size());
    return u8(0);
}

CdrWriter& CdrWriter::f64_array(std::span<const double> values) {
    for (const double value : values) {
        f64(value);
    }
    return *this;
}

CdrWriter& CdrWriter::f64_sequence(std::span<const double> values) {
    return length(values.size()).f64_array(values);
}

CdrWriter& CdrWriter::f32_sequence(std::span<const float> values) {
    length(values.size());
    append(values.data(), values.size_bytes());
    return *this;
}

CdrWriter& CdrWriter::u8_sequence(std::span<const std::uint8_t> values) {
    length(values.size());
    append(values.data(), values.size());
    return *this;
}

std::span<std::uint8_t> CdrWriter::u8_room(std::size_t size) {
    length(size);
    bytes_.resize(bytes_.size() + size);
    return std::span(reinterpret_cast<std::uint8_t*>(bytes_.data()), bytes_.size()).last(size);
}

std::string CdrWriter::take() {
    return std::exchange(bytes_, std::string{});
}

}  // namespace disparityd::formats
