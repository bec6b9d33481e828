# SPDX-License-Identifier: MIT
# host_sim, sv_validate and sv_bench with the plugin and an OpenCL device for any CPU, from the Debian packages of this checkout.
#     docker build -t smartvis .
#     docker run --rm -v "$PWD:/data" smartvis run --volume /data/head.mha --out /data/out
FROM debian:12 AS packages
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates make
COPY . /smartvis
RUN make -C /smartvis deb

FROM debian:12
COPY --from=packages /smartvis/out/deb /tmp/deb
RUN apt-get update \
    && apt-get install -y --no-install-recommends /tmp/deb/smartvis_*.deb /tmp/deb/smartvis-plugin_*.deb \
    && rm -rf /tmp/deb /var/lib/apt/lists/*
ENTRYPOINT ["host_sim"]
