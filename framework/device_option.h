/* What the commands share: opening the device they were asked for, and loading plug-ins. */
#ifndef BB_DEVICE_OPTION_H
#define BB_DEVICE_OPTION_H

#include "framework/cli.h"
#include "framework/device.h"

/* By --device, --form and --kernels-from. */
bb_status bb_open_device(const bb_cli *cli, bb_device **device);

/* All of --plugin. */
bb_status bb_load_plugins(const bb_cli *cli);

#endif
