// SPDX-License-Identifier: Apache-2.0
#include "tools/certificates/revocation.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <openssl/err.h>
#include <openssl/x509v3.h>

#include "base/text_file.h"
#include "tools/certificates/certificate_files.h"
#include "tools/certificates/pem.h"

namespace disparityd::tools {
namespace {

using List = std::unique_ptr<X509_CRL, decltype(&X509_CRL_free)>;
using Time = std::unique_ptr<ASN1_TIME, decltype(&ASN1_TIME_free)>;

constexpr const char* list_begin = "-----BEGIN X509 CRL-----";
constexpr const char* list_end = "-----END X509 CRL-----\n";

/// A day ago: clocks differ, and who looks at a list from tomorrow refuses everybody.
Time yesterday() {
    return {X509_gmtime_adj(nullptr, -24L * 3600), ASN1_TIME_free};
}

EVP_PKEY* key_of(const Certificate& authority) {
    return X509_get0_pubkey(authority.certificate.get());
}

std::string name_of(const X509* certificate) {
    char text[80] = {};
    X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName, text, sizeof text);
    return text;
}

List new_list(const Certificate& authority) {
    List list(X509_CRL_new(), X509_CRL_free);
    constexpr long version_2 = 1;
    check_openssl(list && X509_CRL_set_version(list.get(), version_2) == 1 &&
                      X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(authority.certificate.get())) == 1,
                  "a list of revoked certificates");
    return list;
}

List read_list(const Certificate& authority, const std::string& text) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> memory(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())),
                                                           BIO_free);
    List list(memory ? PEM_read_bio_X509_CRL(memory.get(), nullptr, nullptr, nullptr) : nullptr, X509_CRL_free);
    if (!list || X509_CRL_verify(list.get(), key_of(authority)) != 1) {
        throw std::invalid_argument("the list of revoked certificates is not one of this authority: " +
                                    proto::take_tls_error());
    }
    return list;
}

void add(X509_CRL* list, const Certificate& authority, const X509* certificate) {
    if (X509_NAME_cmp(X509_get_issuer_name(certificate), X509_get_subject_name(authority.certificate.get())) != 0 ||
        X509_verify(const_cast<X509*>(certificate), key_of(authority)) != 1) {
        ERR_clear_error();
        throw std::invalid_argument("the certificate of " + name_of(certificate) + " is not of this authority");
    }
    X509_REVOKED* found = nullptr;
    if (X509_CRL_get0_by_serial(list, &found, X509_get0_serialNumber(certificate)) == 1) {
        throw std::invalid_argument("the certificate of " + name_of(certificate) + " is revoked already");
    }
    std::unique_ptr<X509_REVOKED, decltype(&X509_REVOKED_free)> entry(X509_REVOKED_new(), X509_REVOKED_free);
    const Time since = yesterday();
    check_openssl(entry && since &&
                      X509_REVOKED_set_serialNumber(
                          entry.get(), const_cast<ASN1_INTEGER*>(X509_get0_serialNumber(certificate))) == 1 &&
                      X509_REVOKED_set_revocationDate(entry.get(), since.get()) == 1 &&
                      X509_CRL_add0_revoked(list, entry.get()) == 1,
                  "an entry of the list of revoked certificates");
    static_cast<void>(entry.release());  // the list has it
}

/// Says whose it is and which one it is, as RFC 5280 asks of every list.
void set_extensions(X509_CRL* list, const Certificate& authority) {
    const std::unique_ptr<ASN1_INTEGER, decltype(&ASN1_INTEGER_free)> before(
        static_cast<ASN1_INTEGER*>(X509_CRL_get_ext_d2i(list, NID_crl_number, nullptr, nullptr)), ASN1_INTEGER_free);
    const std::unique_ptr<ASN1_INTEGER, decltype(&ASN1_INTEGER_free)> number(ASN1_INTEGER_new(), ASN1_INTEGER_free);
    check_openssl(number && ASN1_INTEGER_set(number.get(), before ? ASN1_INTEGER_get(before.get()) + 1 : 1) == 1 &&
                      X509_CRL_add1_ext_i2d(list, NID_crl_number, number.get(), 0, X509V3_ADD_REPLACE) == 1,
                  "the number of the list");
    if (before) {
        return;
    }
    X509V3_CTX context{};
    X509V3_set_ctx(&context, authority.certificate.get(), nullptr, nullptr, list, 0);
    const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> whose(
        X509V3_EXT_conf_nid(nullptr, &context, NID_authority_key_identifier, "keyid"), X509_EXTENSION_free);
    check_openssl(whose && X509_CRL_add_ext(list, whose.get(), -1) == 1, "whose the list is");
}

/// Takes the list out of the text of a file, and returns it; empty: there was none.
std::string take_list(std::string& text) {
    const std::size_t begin = text.find(list_begin);
    if (begin == std::string::npos) {
        return {};
    }
    const std::size_t last = text.find(list_end, begin);
    const std::size_t end = last == std::string::npos ? text.size() : last + std::strlen(list_end);
    std::string list = text.substr(begin, end - begin);
    text.erase(begin, end - begin);
    return list;
}

/// A reader sees the file of before or the new one, and one of them stays when the machine stops.
void replace(const std::string& path, const std::string& text) {
    const std::string next = path + ".new";
    std::error_code ignored;
    std::filesystem::remove(next, ignored);  // of a program that was killed
    constexpr mode_t mode = 0644;
    write_new_file(next, text, mode);
    if (std::rename(next.c_str(), path.c_str()) != 0) {
        const int error = errno;
        std::filesystem::remove(next, ignored);
        throw std::runtime_error(path + ": cannot be replaced: " + std::strerror(error));
    }
}

/// Throws for the names of the files that are the daemon's and the authority's own.
void check_is_client(const std::string& name, const std::string& folder) {
    if (name == "server") {
        throw std::invalid_argument(
            "--revoke: found \"server\", the daemon's own certificate, which its clients would refuse, allowed: the "
            "names "
            "of clients; where server.key was stolen: rename server.crt and server.key in " +
            folder + ", make new ones (disparityctl certificates " + folder +
            "), give them to the daemon, then revoke the old one by its new name");
    }
    if (name == "authority") {
        throw std::invalid_argument(
            "--revoke: found \"authority\", which signs the list itself, allowed: the names of clients; where "
            "authority.key was stolen, make all certificates anew in another folder");
    }
}

}  // namespace

std::string revocation_list(const Certificate& authority, const std::string& before,
                            const std::vector<const X509*>& certificates) {
    ERR_clear_error();
    const List list = before.empty() ? new_list(authority) : read_list(authority, before);
    for (const X509* const certificate : certificates) {
        add(list.get(), authority, certificate);
    }
    const Time since = yesterday();
    check_openssl(since && X509_CRL_set1_lastUpdate(list.get(), since.get()) == 1 &&
                      X509_CRL_set1_nextUpdate(list.get(), X509_get0_notAfter(authority.certificate.get())) == 1,
                  "the dates of the list");
    set_extensions(list.get(), authority);
    check_openssl(X509_CRL_sort(list.get()) == 1 && X509_CRL_sign(list.get(), authority.key.get(), EVP_sha256()) > 0,
                  "the signature of the list");
    return pem_text([&](BIO* bio) { return PEM_write_bio_X509_CRL(bio, list.get()); });
}

void revoke_certificates(const std::string& folder, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        check_is_client(name, folder);
    }
    const std::string path = folder + "/authority.crt";
    const Certificate authority = read_authority(path, folder + "/authority.key");
    std::vector<std::unique_ptr<X509, decltype(&X509_free)>> owned;
    std::vector<const X509*> certificates;
    for (const std::string& name : names) {
        owned.emplace_back(read_pem<X509>(folder + '/' + name + ".crt", PEM_read_X509), X509_free);
        certificates.push_back(owned.back().get());
    }
    std::string text = base::read_text_file(path, "the authority's certificate");
    const std::string before = take_list(text);
    replace(path, text + revocation_list(authority, before, certificates));
}

}  // namespace disparityd::tools
