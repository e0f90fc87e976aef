// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include <google/protobuf/stubs/common.h>
#if GOOGLE_PROTOBUF_VERSION < 4022000
#include <google/protobuf/stubs/logging.h>
#endif

#include "base/failure_text.h"
#include "base/freed_memory.h"
#include "base/memory_room.h"
#include "base/message_text.h"
#include "base/out_of_memory.h"
#include "base/program_end.h"
#include "daemon/command_line.h"
#include "daemon/configured_access.h"
#include "daemon/daemon.h"
#include "daemon/engine.h"
#include "daemon/log.h"

namespace {

void print_notes(const std::vector<std::string>& notes) {
    for (const std::string& note : notes) {
        std::printf("disparityd: note: %s\n", disparityd::base::printable_line(note).c_str());
    }
}

int run(int argc, char** argv) {
    const auto line = disparityd::daemon::read_command_line(argc, argv);
    if (!line) {
        return 0;
    }
    const disparityd::daemon::Config config =
        disparityd::daemon::load_config(line->daemon.config_path, line->daemon.overrides);
    disparityd::daemon::set_up_log(config.log);
#if GOOGLE_PROTOBUF_VERSION < 4022000
    google::protobuf::SetLogHandler(nullptr);  // it would print a line for each bad message of a client
#endif
    if (line->check) {
        // Building an engine finds what the text of a configuration cannot show.
        disparityd::daemon::Engine would_run(config, {}, {});
        const std::string work = would_run.work();
        disparityd::daemon::client_access(config);
        disparityd::daemon::client_tls(config);
        print_notes(config.notes);
        for (const std::string& note : {would_run.distances(), would_run.on_demand_note(), would_run.core_share()}) {
            if (!note.empty()) {
                print_notes({note});
            }
        }
        const disparityd::daemon::MemoryBounds memory = would_run.memory();
        print_notes({work});
        std::printf("disparityd: %s\n", memory.text().c_str());
        if (const std::string warning = memory.warning(disparityd::base::memory_room()); !warning.empty()) {
            print_notes({warning});
        }
        std::printf("disparityd: the configuration is valid\n");
        return 0;
    }
    disparityd::daemon::Daemon daemon(line->daemon, config);
    return daemon.run() ? 0 : 1;
}

void print_error(const std::exception& error) {
    const std::string line = disparityd::base::failure_text(error);
    std::fprintf(stderr, "disparityd: error: %s\n", disparityd::base::printable_line(line).c_str());
}

int exit_code(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::invalid_argument& error) {
        print_error(error);
        return 2;
    } catch (const std::exception& error) {
        print_error(error);
        return 1;
    }
}

}  // namespace

int main(int argc, char** argv) {
    disparityd::base::end_when_out_of_memory();
    disparityd::base::set_up_freed_memory();
    return disparityd::base::end_program(exit_code(argc, argv));
}
