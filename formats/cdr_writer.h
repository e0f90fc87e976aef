// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace disparityd::formats {

/// Writes one message as CDR, as ROS 2 does: XCDR version 1, little endian. A number lies at a multiple of its size,
/// counted from the end of the header of 4 bytes; what lies between is 0.
class CdrWriter {
public:
    /// Writes the header. `expected` bytes are allocated at once, the message may have more.
    explicit CdrWriter(std::size_t expected = 0);

    CdrWriter& u8(std::uint8_t value);
    CdrWriter& boolean(bool value);  ///< one byte, 0 or 1
    CdrWriter& i32(std::int32_t value);
    CdrWriter& u32(std::uint32_t value);
    CdrWriter& f32(float value);   ///< IEEE 754
    CdrWriter& f64(double value);  ///< IEEE 754

    /// Writes a string: its length with the 0 at the end, the bytes, the 0. Throws std::length_error beyond 32 bits, as
    /// all that write a length do.
    CdrWriter& text(std::string_view value);

    CdrWriter& f64_array(std::span<const double> values);     ///< of fixed length: no length is written
    CdrWriter& f64_sequence(std::span<const double> values);  ///< a length, then the numbers
    CdrWriter& f32_sequence(std::span<const float> values);   ///< a length, then the numbers
    CdrWriter& u8_sequence(std::span<const std::uint8_t> values);

    /// Writes the length of a sequence; the caller writes its elements.
    CdrWriter& length(std::size_t elements);

    /// Writes a sequence of bytes that are 0, for the caller to fill. The span ends with the next call.
    std::span<std::uint8_t> u8_room(std::size_t size);

    /// Returns the message; the writer is then empty.
    std::string take();

private:
    void align(std::size_t size);
    void append(const void* data, std::size_t size);
    template <typename Number>
    CdrWriter& number(Number value);

    std::string bytes_;
};

}  // namespace disparityd::formats
