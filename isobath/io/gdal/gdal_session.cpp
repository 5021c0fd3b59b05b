#include <algorithm>
#include <cpl_conv.h>
#include <cstdint>
#include <dlfcn.h>
#include <gdal_priv.h>
#include <isobath/io/gdal/gdal_session.hpp>

namespace isobath {
namespace {

void keep(CPLErr level, CPLErrorNum, const char* text) {
  if (auto* session = static_cast<GdalSession*>(CPLGetErrorHandlerUserData()); session && level >= CE_Warning) {
    session->note(level >= CE_Failure, text);
  }
}

/// Turns off the printing of errors in HDF5, which GDAL uses; the function is looked up in the loaded library.
void quiet_hdf5() {
  using SetAuto = int (*)(std::int64_t stack, void* handler, void* data);
  if (void* found = dlsym(RTLD_DEFAULT, "H5Eset_auto2")) reinterpret_cast<SetAuto>(found)(0, nullptr, nullptr);
}

}  // namespace

GdalSession::GdalSession() {
  CPLPushErrorHandlerEx(keep, this);
  CPLErrorReset();
  if (GetGDALDriverManager()->GetDriverCount() == 0) GDALAllRegister();
  quiet_hdf5();
}

GdalSession::~GdalSession() { CPLPopErrorHandler(); }

void GdalSession::forget() {
  CPLErrorReset();
  warnings_ = failures_ = 0;
  first_failure_.clear();
  last_warning_.clear();
}

void GdalSession::note(bool failure, const char* text) {
  std::string line(text ? text : "");
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  if (failure) {
    if (failures_++ == 0) first_failure_ = line;
  } else {
    ++warnings_;
    last_warning_ = line;
  }
}

}  // namespace isobath
