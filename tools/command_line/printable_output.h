// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <streambuf>
#include <string>

namespace disparityd::tools {

/// While this lives, what goes into a stream reaches its target without control characters: names and messages of
/// daemons, files and cameras must not move a terminal's cursor. Line ends and tabs stay, others become "?". One thread
/// writes.
class PrintableOutput final : public std::streambuf {
public:
    explicit PrintableOutput(std::ostream& stream) : stream_(stream), target_(stream.rdbuf(this)) {}
    ~PrintableOutput() override;
    PrintableOutput(const PrintableOutput&) = delete;
    PrintableOutput& operator=(const PrintableOutput&) = delete;

private:
    int_type overflow(int_type character) override;
    std::streamsize xsputn(const char* bytes, std::streamsize count) override;
    int sync() override;

    std::ostream& stream_;
    std::streambuf* target_;
    bool held_back_ = false;  ///< 0xc2 came last: in UTF-8 what follows says whether it begins a control character
};

}  // namespace disparityd::tools
