// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>

#include <openssl/pem.h>

#include "proto/tls/tls_context.h"

namespace disparityd::tools {

/// Throws std::runtime_error with OpenSSL's reason unless it is done.
inline void check_openssl(bool done, const char* what) {
    if (!done) {
        throw std::runtime_error(std::string("OpenSSL cannot make a certificate: ") + what + ": " +
                                 proto::take_tls_error());
    }
}

/// Returns what `write` writes into a BIO.
template <typename Write>
std::string pem_text(Write write) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> memory(BIO_new(BIO_s_mem()), BIO_free);
    check_openssl(memory && write(memory.get()) == 1, "PEM");
    char* text = nullptr;
    const long length = BIO_get_mem_data(memory.get(), &text);
    return {text, static_cast<std::size_t>(length)};
}

/// Reads one object in PEM; the caller owns it. No password is asked for. Throws std::invalid_argument with one line.
template <typename Object, typename Read>
Object* read_pem(const std::string& path, Read read) {
    struct Close {
        void operator()(std::FILE* opened) const { std::fclose(opened); }
    };
    const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "re"));
    Object* const object = file ? read(
                                      file.get(), nullptr, [](char*, int, int, void*) { return 0; }, nullptr)
                                : nullptr;
    if (object == nullptr) {
        throw std::invalid_argument(path +
                                    ": cannot be used: " + (file ? proto::take_tls_error() : "it cannot be read"));
    }
    return object;
}

}  // namespace disparityd::tools
