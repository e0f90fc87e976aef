// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/svo2_writer.h"

#include <algorithm>
#include <bit>
#include <random>

namespace disparityd::test {
namespace {

constexpr std::uint64_t second_ns = 1'000'000'000;
constexpr std::size_t frame_footer_bytes = 56;
constexpr std::size_t sample_bytes = 360;
constexpr int key_frame = 3;

std::string number(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) {
        text.push_back(static_cast<char>(value >> (8 * i)));
    }
    return text;
}

void put(std::string& to, std::size_t place, const std::string& bytes) {
    to.replace(place, bytes.size(), bytes);
}

std::string number(int value) {
    return number(static_cast<std::uint32_t>(value), 4);
}

std::string real(float value) {
    return number(std::bit_cast<std::uint32_t>(value), 4);
}

std::string base64(const std::string& bytes) {
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = i; k < i + 3; ++k) {
            three = three << 8U | (k < bytes.size() ? static_cast<std::uint8_t>(bytes[k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63U];
        }
    }
    return text;
}

std::string noise(int seed, std::size_t size) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::string bytes(size, '\0');
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(random()); });
    return bytes;
}

int told_width(const Svo2File& file) {
    return file.width_of_one_eye ? file.eye_width : 2 * file.eye_width;
}

std::uint64_t in_unit(const Svo2File& file, std::uint64_t time_ns) {
    return time_ns / file.stamp_unit_ns;
}

/// What one matrix corrects is unknown: the unit matrix corrects nothing. How the numbers are kept is made up.
std::string two_matrices() {
    std::string bytes;
    for (int i = 0; i < 18; ++i) {
        bytes += real(i % 9 % 4 == 0 ? 1.0F : 0.0F);
    }
    return base64(bytes);
}

std::string header(const Svo2File& file) {
    if (!file.header_text.empty()) {
        return file.header_text;
    }
    // The description knows the first four fields. That there is more is known, how much is made up.
    const std::string known = number(told_width(file)) + number(file.height) + number(file.serial) + number(file.rate);
    return R"({"zed_sdk_version":"4.1.4","imu_frequency_hz":)" + std::to_string(file.rate * file.samples_per_frame) +
           R"(,"Calib_acc":")" + two_matrices() + R"(","Calib_gyro":")" + two_matrices() + R"(","header":")" +
           base64(known + std::string(240, '\0')) + R"("})";
}

/// The name of the key is made up.
std::string footer(const Svo2File& file) {
    std::string stamps;
    for (const int frame : svo2_frame_numbers(file)) {
        stamps += number(in_unit(file, svo2_frame_ns(file, frame)), 8);
    }
    return R"({"timestamps":")" + base64(stamps) + R"("})";
}

std::string video_message(const Svo2File& file, int frame, int last_key, const Svo2PayloadWriter::Payload& payload) {
    std::string below(frame_footer_bytes, '\0');
    put(below, 0x00, number(told_width(file)));
    put(below, 0x04, number(file.height));
    put(below, 0x18, number(in_unit(file, svo2_frame_ns(file, frame)), 8));
    put(below, 0x20, number(payload.bytes.size(), 4));
    put(below, 0x24, number(payload.key ? key_frame : 0));  // only the number of a key frame is known
    put(below, 0x28, number(last_key));
    put(below, 0x30, number(frame));
    const std::string content = number(payload.bytes.size(), 4) + payload.bytes + below;
    return number(content.size(), 4) + content;
}

/// The name of the key is made up.
std::string sensor_message(const Svo2File& file, const Svo2Sample& sample) {
    std::string bytes(sample_bytes, '\0');
    put(bytes, 0x10, number(in_unit(file, sample.time_ns), 8));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        put(bytes, 0x58 + 4 * axis, real(sample.degrees_per_s[axis]));
        put(bytes, 0x64 + 4 * axis, real(sample.metres_per_s2[axis]));
    }
    return R"({"data":")" + base64(bytes) + R"("})";
}

bool has(const std::vector<int>& numbers, int one) {
    return std::find(numbers.begin(), numbers.end(), one) != numbers.end();
}

/// The topics of a file, and its messages in the order of their times.
class Topics {
public:
    explicit Topics(const Svo2File& file)
        : file_(file), camera_("Camera_SN" + std::to_string(file.serial) + "/"), writer_(file.mcap, "") {
        if (file.has_header) {
            writer_.message(writer_.channel(0, "svo_header", "json"), 0, file.first_ns, header(file));
        }
        video_ = writer_.channel(0, file.video_topic.empty() ? camera_ + "side_by_side" : file.video_topic, "");
        for (const std::string& topic : file.more_topics) {
            more_.push_back(writer_.channel(0, topic, "unknown"));
        }
        if (file.has_sensors) {
            sensors_ = writer_.channel(0, camera_ + "sensors", "json");
            integrated_ = writer_.channel(0, camera_ + "sensors_integrated", "json");
        }
    }

    void frame(int number, const std::string& message) {
        const std::uint64_t time = svo2_frame_ns(file_, number);
        const auto sequence = static_cast<std::uint32_t>(number);
        writer_.message(video_, sequence, time, message);
        for (const std::uint16_t topic : more_) {
            writer_.message(topic, sequence, time, noise(number, 100));
        }
    }

    /// The samples between this frame and the next one.
    void samples(int number) {
        for (int i = 0; file_.has_sensors && i < file_.samples_per_frame; ++i) {
            const int index = number * file_.samples_per_frame + i;
            const Svo2Sample sample = svo2_sample(file_, index);
            writer_.message(sensors_, static_cast<std::uint32_t>(index), sample.time_ns, sensor_message(file_, sample));
        }
        if (file_.has_sensors) {
            // What it holds is not known.
            writer_.message(integrated_, static_cast<std::uint32_t>(number), svo2_frame_ns(file_, number),
                            R"({"data":")" + base64(noise(number, 100)) + R"("})");
        }
    }

    std::string close() {
        if (file_.has_footer) {
            const std::uint64_t end = svo2_frame_ns(file_, file_.frames);
            writer_.message(writer_.channel(0, "svo_footer", "json"), 0, end, footer(file_));
        }
        return writer_.close();
    }

private:
    const Svo2File& file_;
    const std::string camera_;
    McapWriter writer_;
    std::uint16_t video_ = 0;
    std::uint16_t sensors_ = 0;
    std::uint16_t integrated_ = 0;
    std::vector<std::uint16_t> more_;
};

}  // namespace

Svo2Sample svo2_sample(const Svo2File& file, int index) {
    const auto samples_per_s = static_cast<std::uint64_t>(file.rate * file.samples_per_frame);
    const std::uint64_t time = file.first_ns + static_cast<std::uint64_t>(index) * second_ns / samples_per_s;
    const auto turn = static_cast<float>(index % 16);
    return {time / file.stamp_unit_ns * file.stamp_unit_ns,
            {0.5F * turn, -0.25F * turn, 90.0F},
            {0.125F * turn, 9.75F, -0.5F}};
}

std::uint64_t svo2_frame_ns(const Svo2File& file, int frame) {
    const std::uint64_t time =
        file.first_ns + static_cast<std::uint64_t>(frame) * second_ns / static_cast<std::uint64_t>(file.rate);
    return time / file.stamp_unit_ns * file.stamp_unit_ns;
}

std::vector<int> svo2_frame_numbers(const Svo2File& file) {
    std::vector<int> numbers;
    for (int frame = 0; frame < file.frames; ++frame) {
        if (!has(file.lost, frame) && !has(file.unwritten, frame)) {
            numbers.push_back(frame);
        }
    }
    return numbers;
}

std::string svo2_bytes(const Svo2File& file) {
    Topics topics(file);
    Svo2PayloadWriter payloads(file.payload, 2 * file.eye_width, file.height, file.key_distance);
    int last_key = 0;
    for (int frame = 0; frame < file.frames; ++frame) {
        if (!has(file.lost, frame)) {
            const auto payload = payloads.next(
                file.draw ? file.draw(frame) : svo2_picture(file.eye_width, file.height, file.disparity, frame));
            last_key = payload.key ? frame : last_key;
            std::string message = video_message(file, frame, last_key, payload);
            if (file.change) {
                file.change(message, frame);
            }
            if (!has(file.unwritten, frame)) {
                topics.frame(frame, message);
            }
        }
        topics.samples(frame);
    }
    return topics.close();
}

std::string svo1_bytes() {
    return "SVO1" + noise(1, 60'000);
}

}  // namespace disparityd::test
