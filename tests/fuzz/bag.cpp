// SPDX-License-Identifier: Apache-2.0
//
// MCAP files and bags of ROS 1: their records, chunks, schemas and messages, and a bag as a source, from which frames
// are read.
#include <algorithm>

#include "capture/bag/bag_reader.h"
#include "capture/frame_source.h"
#include "formats/ros_bag.h"
#include "formats/ros_message.h"
#include "tests/fuzz/first_frames.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

/// Whether both refusals of a reader are lines that begin with the file.
template <class Parser>
void expect_refusal_in_a_line(const std::string& begin, Parser&& parser) {
    fuzz::accepted<std::invalid_argument>(begin, [&] { fuzz::accepted<std::runtime_error>(begin, parser); });
}

void read_messages(const std::string& path) {
    const auto bag = formats::open_ros_bag(path);
    formats::RosBag::Message message;
    while (bag->next(message)) {
        const formats::BagConnection connection = bag->connections().at(message.connection);
        const auto encoding = connection.encoding == "ros1" ? formats::RosEncoding::ros1 : formats::RosEncoding::cdr;
        fuzz::accepted<std::runtime_error>("", [&] {
            const formats::RosMessage fields(formats::parse_ros_schema(connection.type, *connection.definition),
                                             message.data, encoding);
            fuzz::expect(fields.fields().size() <= message.data.size(), "fields without bytes");
        });
    }
}

void read_frames(const std::string& path) {
    capture::BagUri uri;
    uri.path = path;
    uri.within_ns = 1'000'000'000;
    capture::BagReader reader(uri, true);
    fuzz::read_first_frames(reader);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::MemoryFile file(fuzz::text_of(data, size));
    expect_refusal_in_a_line(file.path(), [&] { read_messages(file.path()); });
    fuzz::accepted<std::invalid_argument>(
        "", [&] { fuzz::accepted<std::runtime_error>("", [&] { read_frames(file.path()); }); });
    return 0;
}
