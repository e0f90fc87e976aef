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

/// Returns the file that lies unpacked beside one that was packed as a whole (--compression-mode file). Throws
/// std::invalid_argument with the command that unpacks it.
std::string unpacked_file(const std::filesystem::path& path) {
    const std::string unpacked =
        path.extension() == ".zstd" ? std::filesystem::path(path).replace_extension().string() : path.string();
    if (!base::is_file(unpacked)) {
        throw std::invalid_argument(base::printable(path.string(), longest_path) +
                                    ": is packed as a whole (--compression-mode file) and not read so; unpack the "
                                    "files of the bag, then it is played: " +
                                    formats::zstd_command(path.string()));
    }
    return unpacked;
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
        const bool packed = !packing.empty() && base::lower_case(word(bag["compression_mode"])) == "file";
        for (const YAML::Node& file : bag["relative_file_paths"]) {
            // Older bags name the folder, too; none may lead out of it.
            const std::filesystem::path path = folder / std::filesystem::path(word(file)).filename();
            files.push_back(packed ? unpacked_file(path) : path.string());
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
    type_of_connection_.clear();
    types_.clear();
    reader_ = formats::open_ros_bag(files_[file]);
    file_ = file;
}

bool BagMessages::has_all_topics() const {
    return files_.size() == 1 && reader_->lists_all();
}

std::vector<BagTopic> BagMessages::topics() const {
    std::vector<BagTopic> topics = earlier_;
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < topics.size(); ++i) {
        places.emplace(topics[i].name, i);
    }
    for (const auto& [id, connection] : reader_->connections()) {
        const auto count = files_.size() == 1 ? connection.messages : std::nullopt;
        const auto [place, is_new] = places.emplace(connection.topic, topics.size());
        if (is_new) {
            topics.push_back({connection.topic, connection.type, count});
        } else {  // several writers on one topic
            auto& messages = topics[place->second].messages;
            messages = messages && count ? std::optional(*messages + *count) : std::nullopt;
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

/// A bag may have thousands of connections of one type, whose definition is parsed once.
const BagMessages::Type& BagMessages::type_of(std::uint32_t connection) {
    const Type*& known = type_of_connection_[connection];
    if (known == nullptr) {
        const formats::BagConnection& found = reader_->connections().at(connection);
        const TypeText text{found.type, found.encoding, found.definition_encoding, *found.definition};
        auto parsed = types_.find(text);
        if (parsed == types_.end()) {
            parsed = types_.emplace(text, parse(found)).first;
        }
        known = &parsed->second;
    }
    return *known;
}

BagMessages::Type BagMessages::parse(const formats::BagConnection& found) {
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
    return {formats::parse_ros_schema(found.type, text), encoding};
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
