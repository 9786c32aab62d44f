// SPDX-License-Identifier: Apache-2.0
#pragma once

// Declares the parts of CHAI3D 3.3 that kerf_chai3d.h uses, with the same names and types, so that
// it runs where CHAI3D is missing. compile.sh compiles the same header against CHAI3D itself.

#include <cmath>
#include <memory>
#include <string>

namespace chai3d {

class cVector3d {
 public:
  cVector3d(double x = 0, double y = 0, double z = 0) : v_{x, y, z} {}
  double x() const { return v_[0]; }
  double y() const { return v_[1]; }
  double z() const { return v_[2]; }
  cVector3d operator*(double s) const { return {v_[0] * s, v_[1] * s, v_[2] * s}; }
  void normalize() { *this = *this * (1 / std::hypot(v_[0], v_[1], v_[2])); }

 private:
  double v_[3];
};

class cMatrix3d {
 public:
  /// Columns.
  cMatrix3d(cVector3d a = {1, 0, 0}, cVector3d b = {0, 1, 0}, cVector3d c = {0, 0, 1})
      : c_{a, b, c} {}
  cVector3d operator*(const cVector3d& v) const {
    return {c_[0].x() * v.x() + c_[1].x() * v.y() + c_[2].x() * v.z(),
            c_[0].y() * v.x() + c_[1].y() * v.y() + c_[2].y() * v.z(),
            c_[0].z() * v.x() + c_[1].z() * v.y() + c_[2].z() * v.z()};
  }

 private:
  cVector3d c_[3];
};

struct cHapticDeviceInfo {
  std::string m_modelName;
  double m_maxLinearForce = 0, m_maxAngularTorque = 0;
  double m_maxLinearStiffness = 0, m_maxLinearDamping = 0;
  bool m_sensedPosition = false, m_sensedRotation = false;
  bool m_actuatedPosition = false, m_actuatedRotation = false;
};

class cGenericHapticDevice;
using cGenericHapticDevicePtr = std::shared_ptr<cGenericHapticDevice>;

class cGenericHapticDevice {
 public:
  virtual ~cGenericHapticDevice() = default;
  virtual bool getPosition(cVector3d& position) = 0;
  virtual bool getRotation(cMatrix3d& rotation) = 0;
  virtual bool getUserSwitch(int index, bool& status) = 0;
  virtual bool setForceAndTorqueAndGripperForce(const cVector3d& force, const cVector3d& torque,
                                                double gripper) = 0;
  cHapticDeviceInfo getSpecifications() { return m_specifications; }

 protected:
  cHapticDeviceInfo m_specifications;
};

}  // namespace chai3d
