"""The networks: one file each. `build.build_network` turns a `config.NetworkConfig` into a module."""
