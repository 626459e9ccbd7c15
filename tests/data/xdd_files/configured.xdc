<?xml version="1.0" encoding="UTF-8"?>
<ISO15745ProfileContainer xmlns="http://www.canopen.org/xml/1.0" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
  <ISO15745Profile>
    <ProfileBody xsi:type="ProfileBody_CommunicationNetwork_CANopen">
      <ApplicationLayers>
        <CANopenObjectList>
          <CANopenObject index="1014" name="COB-ID EMCY" objectType="7" dataType="0007" accessType="rw" defaultValue="$NODEID+0x80" actualValue="0x85" denotation="of nobody"/>
          <CANopenObject index="1017" name="Heartbeat" objectType="7" dataType="0006" accessType="rw" defaultValue="0" lowLimit="0" highLimit="5000"/>
        </CANopenObjectList>
      </ApplicationLayers>
      <NetworkManagement>
        <deviceCommissioning nodeID="5" nodeName="Axis" actualBaudRate="250 Kbps" networkNumber="1" networkName=""/>
      </NetworkManagement>
    </ProfileBody>
  </ISO15745Profile>
</ISO15745ProfileContainer>
