// SPDX-License-Identifier: Apache-2.0
#pragma once

// What threemf_writer.cpp uses of zlib's minizip, which Debian does not have for WebAssembly. Parts
// are stored as they are, not compressed.

#include <cstdint>

using voidpf = void*;
using uLong = unsigned long;
using ZPOS64_T = std::uint64_t;

inline constexpr int ZLIB_FILEFUNC_SEEK_CUR = 1, ZLIB_FILEFUNC_SEEK_END = 2,
                     ZLIB_FILEFUNC_SEEK_SET = 0;
inline constexpr int APPEND_STATUS_CREATE = 0, ZIP_OK = 0, ZIP_ERRNO = -1, Z_DEFLATED = 8;

struct zlib_filefunc64_def {
  voidpf (*zopen64_file)(voidpf opaque, const void* name, int mode);
  uLong (*zread_file)(voidpf opaque, voidpf stream, void* to, uLong size);
  uLong (*zwrite_file)(voidpf opaque, voidpf stream, const void* from, uLong size);
  ZPOS64_T (*ztell64_file)(voidpf opaque, voidpf stream);
  long (*zseek64_file)(voidpf opaque, voidpf stream, ZPOS64_T offset, int from);
  int (*zclose_file)(voidpf opaque, voidpf stream);
  int (*zerror_file)(voidpf opaque, voidpf stream);
  voidpf opaque;
};

struct zip_fileinfo {
  uLong dosDate;
};

using zipFile = struct StoredZip*;

zipFile zipOpen2_64(const void* name, int append, const char** comment,
                    zlib_filefunc64_def* functions);
int zipOpenNewFileInZip64(zipFile zip, const char* name, const zip_fileinfo* info,
                          const void* local_extra, unsigned local_bytes, const void* global_extra,
                          unsigned global_bytes, const char* comment, int method, int level,
                          int zip64);
int zipWriteInFileInZip(zipFile zip, const void* from, unsigned size);
int zipCloseFileInZip(zipFile zip);
int zipClose(zipFile zip, const char* comment);
