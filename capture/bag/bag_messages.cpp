// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_messages.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "formats/ros_definitions.h"
#include "formats/unpack.h"

namespace disparityd::capture {
namespace {

constexpr std::size_t longest_path = 300;

std::string word(const YAML::Node& node) {
    return node && node.IsScalar() ? node.Scalar() : std::string();
}

/// Returns the files that metadata.yaml names, within its folder.
std::vector<std::string> files_of_folder(const std::filesystem::path& folder) {
    const std::string path = (folder / "metadata.yaml").string();
    const std::string text = base::read_text_file(path, "bag");
    const auto refuse = [&](const std::string& what) { throw std::invalid_argument(path + ": " + what); };
    std::vector<std::string> files;
    try {
        const YAML::Node bag = YAML::Load(text)["rosbag2_bagfile_information"];
        if (!bag || !bag.IsMap()) {
            refuse("has no rosbag2_bagfile_information: this is no ROS 2 bag");
        }
        if (const std::string kind = word(bag["storage_identifier"]); kind != "mcap" && kind != "sqlite3") {
            refuse("found a bag stored as '" + base::printable(kind) +
                   "', allowed are mcap and sqlite3: convert it with ros2 bag convert");
        }
        const std::string packing = word(bag["compression_format"]);
        if (!packing.empty() && packing != "zstd") {
            refuse("found a bag packed by '" + base::printable(packing) +
                   "', allowed is zstd: convert it with ros2 bag convert");
        }
        if (!packing.empty() && base::lower_case(word(bag["compression_mode"])) == "file") {
            refuse(
                "found a bag whose files are packed (--compression-mode file), which is not read: unpack them with "
                "unzstd and name one of them, or convert the bag with ros2 bag convert");
        }
        for (const YAML::Node& file : bag["relative_file_paths"]) {
            // Older bags name the folder, too; none may lead out of it.
            files.push_back((folder / std::filesystem::path(word(file)).filename()).string());
        }
    } catch (const YAML::Exception& error) {
        refuse("is no YAML file: line " + std::to_string(error.mark.line + 1) + ": " + base::printable(error.msg));
    }
    if (files.empty()) {
        refuse("names no file (relative_file_paths)");
    }
    return files;
}

std::int64_t clamped(std::uint64_t ns) {
    constexpr std::uint64_t most = 4'000'000'000'000'000'000;  // the year 2096; differences of times fit
    return static_cast<std::int64_t>(std::min(ns, most));
}

}  // namespace

BagMessages::BagMessages(const std::string& path)
    : files_(base::is_folder(path) ? files_of_folder(path) : std::vector<std::string>{path}) {
    open(0);
}

void BagMessages::open(std::size_t file) {
    if (reader_) {
        before_ += reader_->position();
        earlier_ = topics();
    }
    types_.clear();
    reader_ = formats::open_ros_bag(files_[file]);
    file_ = file;
}

bool BagMessages::has_all_topics() const {
    return files_.size() == 1 && reader_->lists_all();
}

std::vector<BagTopic> BagMessages::topics() const {
    std::vector<BagTopic> topics = earlier_;
    for (const auto& [id, connection] : reader_->connections()) {
        const auto count = files_.size() == 1 ? connection.messages : std::nullopt;
        const auto known =
            std::find_if(topics.begin(), topics.end(),
                         [&name = connection.topic](const BagTopic& topic) { return topic.name == name; });
        if (known != topics.end()) {  // several writers on one topic
            known->messages = known->messages && count ? std::optional(*known->messages + *count) : std::nullopt;
        } else {
            topics.push_back({connection.topic, connection.type, count});
        }
    }
    return topics;
}

bool BagMessages::next(Message& message) {
    formats::RosBag::Message found;
    while (!reader_->next(found)) {
        if (file_ + 1 == files_.size()) {
            return false;
        }
        open(file_ + 1);
    }
    connection_ = found.connection;
    message.topic = found.topic;
    message.log_ns = clamped(found.log_ns);
    message.data = found.data;
    return true;
}

void BagMessages::fail(const Message& message, const std::string& what) const {
    throw std::runtime_error(base::printable(files_[file_], longest_path) + ": " + base::printable(message.topic) +
                             ": " + what);
}

const BagMessages::Type& BagMessages::type_of(std::uint32_t connection) {
    if (const auto known = types_.find(connection); known != types_.end()) {
        return known->second;
    }
    const formats::BagConnection found = reader_->connections().at(connection);
    if (found.encoding != "cdr" && found.encoding != "ros1") {
        throw std::runtime_error("found messages encoded as '" + base::printable(found.encoding) +
                                 "', allowed are cdr and ros1");
    }
    const bool cdr = found.encoding == "cdr";
    const bool usable = !found.definition->empty() && found.definition_encoding == (cdr ? "ros2msg" : "ros1msg");
    const std::string_view text =
        usable || !cdr ? std::string_view(*found.definition) : formats::published_definition(found.type);
    if (text.empty() || (!usable && !cdr)) {
        throw std::runtime_error("found a definition written as '" + base::printable(found.definition_encoding) +
                                 "' of the type '" + base::printable(found.type) + "', allowed is ros2msg or ros1msg");
    }
    const formats::RosEncoding encoding = cdr ? formats::RosEncoding::cdr : formats::RosEncoding::ros1;
    return types_.emplace(connection, Type{formats::parse_ros_schema(found.type, text), encoding}).first->second;
}

/// Unpacks a message of a bag that was recorded with --compression-mode message. No message of CDR begins so.
void BagMessages::unpack(std::span<const std::uint8_t>& data) {
    constexpr std::array<std::uint8_t, 4> zstd{0x28, 0xb5, 0x2f, 0xfd};
    if (data.size() >= zstd.size() && std::equal(zstd.begin(), zstd.end(), data.begin())) {
        formats::unpack_zstd_message(data, unpacked_);
        data = unpacked_;
    }
}

formats::RosMessage BagMessages::decode(const Message& message) {
    try {
        const Type& type = type_of(connection_);
        std::span<const std::uint8_t> data = message.data;
        if (type.encoding == formats::RosEncoding::cdr) {
            unpack(data);
        }
        return {type.schema, data, type.encoding};
    } catch (const std::runtime_error& error) {
        fail(message, error.what());
    }
}

}  // namespace disparityd::capture
