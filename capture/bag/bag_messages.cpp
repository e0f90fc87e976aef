// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_messages.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/text_file.h"

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
        if (const std::string kind = word(bag["storage_identifier"]); kind != "mcap") {
            refuse("found a bag stored as '" + base::printable(kind) +
                   "', allowed is mcap: convert it with ros2 bag convert");
        }
        if (const std::string packing = word(bag["compression_format"]); !packing.empty()) {
            refuse("found a bag packed by '" + base::printable(packing) +
                   "' (--compression-mode), allowed are MCAP's own chunks: convert it with ros2 bag convert");
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
    schemas_.clear();
    reader_ = std::make_unique<formats::McapReader>(files_[file]);
    file_ = file;
}

bool BagMessages::has_all_topics() const {
    return files_.size() == 1 && reader_->has_summary();
}

std::vector<BagTopic> BagMessages::topics() const {
    std::vector<BagTopic> topics = earlier_;
    const formats::McapDefinitions& definitions = reader_->definitions();
    for (const auto& [id, channel] : definitions.channels()) {
        const auto count = files_.size() == 1 ? reader_->message_count(id) : std::nullopt;
        const auto known = std::find_if(topics.begin(), topics.end(),
                                        [&name = channel.topic](const BagTopic& topic) { return topic.name == name; });
        if (known != topics.end()) {  // several writers on one topic
            known->messages = known->messages && count ? std::optional(*known->messages + *count) : std::nullopt;
        } else {
            const auto schema = definitions.schemas().find(channel.schema);
            topics.push_back(
                {channel.topic, schema == definitions.schemas().end() ? std::string() : schema->second.name, count});
        }
    }
    return topics;
}

bool BagMessages::next(Message& message) {
    formats::McapMessage found;
    while (!reader_->next(found)) {
        if (file_ + 1 == files_.size()) {
            return false;
        }
        open(file_ + 1);
    }
    channel_ = found.channel;
    message.topic = reader_->definitions().channels().at(found.channel).topic;
    message.log_ns = clamped(found.log_ns);
    message.data = found.data;
    return true;
}

void BagMessages::fail(const Message& message, const std::string& what) const {
    throw std::runtime_error(base::printable(files_[file_], longest_path) + ": " + base::printable(message.topic) +
                             ": " + what);
}

const formats::RosSchema& BagMessages::schema_of(std::uint16_t channel) {
    if (const auto known = schemas_.find(channel); known != schemas_.end()) {
        return known->second;
    }
    const formats::McapDefinitions& definitions = reader_->definitions();
    const formats::McapChannel& found = definitions.channels().at(channel);
    if (found.message_encoding != "cdr" || found.schema == 0) {
        throw std::runtime_error("found messages encoded as '" + base::printable(found.message_encoding) +
                                 "', allowed is cdr with a schema");
    }
    const formats::McapSchema& schema = definitions.schemas().at(found.schema);
    if (schema.encoding != "ros2msg") {
        throw std::runtime_error("found a schema written as '" + base::printable(schema.encoding) +
                                 "', allowed is ros2msg");
    }
    return schemas_.emplace(channel, formats::parse_ros_schema(schema.name, schema.text)).first->second;
}

formats::RosMessage BagMessages::decode(const Message& message) {
    try {
        return {schema_of(channel_), message.data};
    } catch (const std::runtime_error& error) {
        fail(message, error.what());
    }
}

}  // namespace disparityd::capture
